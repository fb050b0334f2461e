#pragma once

// Before a loop whose iterations may be computed together, though what it writes overlaps what it reads.
#ifdef __clang__
#define ROBOT_VISION_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define ROBOT_VISION_INDEPENDENT _Pragma("GCC ivdep")
#endif
