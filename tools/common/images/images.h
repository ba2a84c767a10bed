/* Reading and writing images by tools. */
#pragma once

#include "tool.h"

#include "io/image/image_sample.h"

/* Read an image from a file ("-": standard input), and report assumptions; exits on failure. */
void tool_read_image(const struct tool *tool, const char *file, struct image *image);

/* The value of the option -i, or linear. Exits on another name. */
enum image_method tool_image_method(const struct tool *tool);

/* Exit if the name of tool->output does not end as that of an image which can be written, or standard output
 * is a terminal. Call this before long computations. */
void tool_check_image_output(const struct tool *tool);

/* Write an image to tool->output, in the format of its name, else that of the image; exits on failure. */
void tool_write_image(const struct tool *tool, const struct image *image);

/* "181 x 217 x 181 voxels of 1 x 1 x 1 mm" into text[128]; returns it. */
const char *image_text(const struct image *image, char text[128]);
