#pragma once

#include <sys/socket.h>
#include <sys/types.h>

#include <cstddef>
#include <string>
#include <type_traits>

#include "fork_count.hpp"

namespace robot_vision
{

/// Unix sockets of whole packets, which may have one descriptor each. Their abstract names are in no file system and
/// end with them; they can be reached in the same network namespace. All functions throw SharedMemoryError, unless said
/// otherwise.

Descriptor listenAt(const std::string& abstract_name);

/// Waits for the connection, and later for each packet, at most so many seconds.
Descriptor connectTo(const std::string& abstract_name, double timeout);

/// Whether the process at the other end was this one's user when it connected or began to listen, as the kernel tells.
/// Throws nothing.
bool isOfThisUser(const Descriptor& socket);

/// Sends without waiting. False if that is not possible: the other end is gone or does not read.
bool sendPacket(const Descriptor& socket, const void* packet, std::size_t bytes, const Descriptor& passed);

enum class Received
{
  kPacket,   // of just that many bytes, with at most one descriptor
  kNothing,  // there is none yet, or none came in time
  kEnded,    // the other end is gone
  kCut,      // descriptors were lost: this process has none left, or there were more than one
  kFaulty    // of another size
};
Received receivePacket(const Descriptor& socket, void* packet, std::size_t bytes, Descriptor& passed, int flags);

template <class Packet>
bool send(const Descriptor& socket, const Packet& packet, const Descriptor& passed = Descriptor())
{
  static_assert(std::is_trivially_copyable_v<Packet> && std::has_unique_object_representations_v<Packet>);
  return sendPacket(socket, &packet, sizeof(packet), passed);
}

template <class Packet>
Received receive(const Descriptor& socket, Packet& packet, Descriptor& passed, int flags = 0)
{
  static_assert(std::is_trivially_copyable_v<Packet> && std::has_unique_object_representations_v<Packet>);
  return receivePacket(socket, &packet, sizeof(packet), passed, flags);
}

}  // namespace robot_vision
