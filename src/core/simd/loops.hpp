#pragma once

// Stands before a loop that may be vectorized although the memory that it writes overlaps the memory that it reads.
#ifdef __clang__
#define ROBOT_VISION_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define ROBOT_VISION_INDEPENDENT _Pragma("GCC ivdep")
#endif
