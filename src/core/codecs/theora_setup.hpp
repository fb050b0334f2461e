#pragma once

#include <cstdint>
#include <vector>

namespace robot_vision
{

/// Whether the packet is a complete setup header of a Theora stream (Theora specification, 6.4). Others must not reach
/// libtheora: version 1.2.0alpha1, which Debian 13 has, frees its Huffman tables twice when it refuses one.
bool isTheoraSetup(const std::vector<std::uint8_t>& packet);

}  // namespace robot_vision
