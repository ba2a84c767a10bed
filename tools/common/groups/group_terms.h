/* Terms of expressions: private to group_terms.c and group_places.c. */
#pragma once

#include "groups/group_select.h"

/* A term, and the input of its evaluation. */
struct term {
    const struct group_body *body;
    enum group_kind kind;
    const char *text;      /* the whole term */
    const char *arguments; /* behind its colon */
    double unit;           /* m */
    bool *chosen;
    struct error *error;
};

/* Parse `least` to `most` numbers; `form` describes them in messages. */
MUST_CHECK enum status term_numbers(const struct term *term, int least, int most, const char *form,
                                    double values[], int *count);
void term_scale(int count, double values[], double unit);

/* Check that a direction has a length. */
MUST_CHECK enum status term_check_direction(const struct term *term, const double *direction);

/* Terms by place, and by a file. */
MUST_CHECK enum status term_box(const struct term *term);
MUST_CHECK enum status term_ball(const struct term *term);
MUST_CHECK enum status term_plane(const struct term *term);
MUST_CHECK enum status term_end(const struct term *term);
MUST_CHECK enum status term_near(const struct term *term);
