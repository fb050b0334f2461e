// Compiled once for each instruction set, with ROBOT_VISION_KERNELS the name of its table and ROBOT_VISION_SET that of
// the set. No function of a header may be compiled here unless it is inlined for sure: the linker keeps one copy of
// each for all of the library, which could be one with instructions that the machine does not have.

#include "core/color/hsv_rows.hpp"
#include "core/edges/edge_rows.hpp"
#include "core/image/bayer_rows.hpp"
#include "core/image/bit_rows.hpp"
#include "core/image/gray_pixels.hpp"
#include "core/image/table_rows.hpp"
#include "core/image/weighted_rows.hpp"
#include "core/image/yuv_rows.hpp"
#include "core/line/line_rows.hpp"
#include "kernels.hpp"

namespace robot_vision
{

extern const Kernels ROBOT_VISION_KERNELS;
const Kernels ROBOT_VISION_KERNELS = {
    ROBOT_VISION_SET,
    slide<std::uint16_t>,
    slide<std::uint32_t>,
    widen<std::uint16_t>,
    widen<std::uint32_t>,
    divide16,
    divide32,
    gradient<std::int16_t>,
    gradient<std::int32_t>,
    suppress<std::int16_t>,
    suppress<std::int32_t>,
    applyLine,
    lookUp,
    kFastLookUp,
    weighColumns,
    weighRow,
    markDifferences,
    splitMarks,
    unite,
    uniteNeighbours,
    spreadBits,
    applyTests,
    kMakeGray,
    everySecond,
    kColourYuv,
    kColourBayer,
};

}  // namespace robot_vision
