/* Kinds of conditions and loads, which scenes name. */
#pragma once

enum condition_kind { CONDITION_COMPONENTS, CONDITION_NORMAL, CONDITION_TABLE, CONDITION_POINTS };

enum curve_kind {
    CURVE_SMOOTH, /* 10 s^3 - 15 s^4 + 6 s^5: no velocity and acceleration at s = 0 and 1 */
    CURVE_LINEAR, /* s */
    CURVE_STEP,   /* 1 from s = 0 on */
    CURVE_TABLE   /* through given points, monotone between them */
};

/* The part of a fluid whose pressure acts: below its level, above it (where the pressure is negative), or
 * all. */
enum fluid_part { FLUID_BELOW, FLUID_ABOVE, FLUID_ALL };
