/* What counts as round-off, and the step of differences. */
#pragma once

/* Of a number that is computed, by those that it is computed from. */
#define ROUND_OFF 1e-12

/* Of places and other numbers that have passed through several computations or a file, by the largest of
 * them: units are converted, maps inverted, digits cut. Nearer ones are the same. */
#define COARSE_ROUND_OFF 1e-9

/* Strain by which a body is moved to measure the derivative of its forces by a difference. */
#define DIFFERENCE_STEP 1e-6
