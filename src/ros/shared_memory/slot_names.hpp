#pragma once

#include <cstdint>
#include <string>

namespace robot_vision
{

/// The name of a publisher's abstract socket: "robot_vision/" and 32 hexadecimal digits.
std::string slotSocketName(std::uint64_t high, std::uint64_t low);

/// Whether it can be one. Others are never connected to: a message may name any socket.
bool isSlotSocketName(const std::string& name);

}  // namespace robot_vision
