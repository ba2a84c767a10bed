/* A stopwatch for cost reports. It never enters a result. */
#pragma once

/* Seconds of a clock that only goes forward. */
double clock_seconds(void);
