/* Values by label, as options give them. */
#pragma once

#include "tool.h"

#include "io/image/image.h"

/* Values of labels of an image; label -1: all others. */
enum { MOST_LABELS = 256 };
struct label_values {
    int count;
    double label[MOST_LABELS], value[MOST_LABELS];
};

/* Parse the value V or LABEL=V,... of an option; without it there are none. Exits for values that the image
 * cannot have, labels that it has not, and two values for one label. */
void label_values_parse(const struct tool *tool, const char *option, const struct image *image,
                        struct label_values *values);

/* The value of a label, or of all others (NAN: among them); NAN: none. */
double label_value(const struct label_values *values, double label);
