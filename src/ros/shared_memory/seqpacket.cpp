#include "seqpacket.hpp"

#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

#include "shared_memory_error.hpp"

namespace robot_vision
{
namespace
{

constexpr int kBacklog = 128;  // connections that wait to be accepted

struct Address
{
  sockaddr_un value{};
  socklen_t bytes = 0;
};

Address abstractAddress(const std::string& name)
{
  Address address;
  address.value.sun_family = AF_UNIX;
  const std::size_t length = std::min(name.size(), sizeof(address.value.sun_path) - 1);
  std::memcpy(address.value.sun_path + 1, name.data(), length);
  address.bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return address;
}

[[noreturn]] void throwSocketError(const std::string& what)
{
  const bool elsewhere = errno == ECONNREFUSED || errno == EAGAIN;
  throw SharedMemoryError(elsewhere ? SharedMemoryFault::kUnreachable : SharedMemoryFault::kNoDescriptors,
                          what + ": " + std::strerror(errno));
}

Descriptor makeSocket()
{
  Descriptor socket(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  if (!socket) throwSocketError("no socket for images in shared memory");
  return socket;
}

/// Room for one descriptor beside a packet. If more are sent, the system closes them and says so.
struct Control
{
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> bytes{};
};

/// The descriptors that came with a packet: there is room for two, though packets have one at most.
std::vector<Descriptor> passedDescriptors(msghdr& header)
{
  std::vector<Descriptor> passed;
  for (cmsghdr* item = CMSG_FIRSTHDR(&header); item != nullptr; item = CMSG_NXTHDR(&header, item))
  {
    if (item->cmsg_level != SOL_SOCKET || item->cmsg_type != SCM_RIGHTS) continue;
    for (std::size_t at = 0; CMSG_LEN(at + sizeof(int)) <= item->cmsg_len; at += sizeof(int))
    {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(item) + at, sizeof(number));
      passed.emplace_back(number);
    }
  }
  return passed;
}

}  // namespace

Descriptor listenAt(const std::string& abstract_name)
{
  Descriptor socket = makeSocket();
  const Address address = abstractAddress(abstract_name);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&address.value), address.bytes) != 0 ||
      listen(socket.get(), kBacklog) != 0)
    throwSocketError("no socket '" + abstract_name + "' for images in shared memory");
  return socket;
}

Descriptor connectTo(const std::string& abstract_name, double timeout)
{
  Descriptor socket = makeSocket();
  timeval time{};
  time.tv_sec = static_cast<time_t>(timeout);
  time.tv_usec = static_cast<suseconds_t>((timeout - static_cast<double>(time.tv_sec)) * 1e6);
  setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &time, sizeof(time));
  setsockopt(socket.get(), SOL_SOCKET, SO_SNDTIMEO, &time, sizeof(time));  // connect() waits that long, too
  const Address address = abstractAddress(abstract_name);
  int connected;
  do
    connected = connect(socket.get(), reinterpret_cast<const sockaddr*>(&address.value), address.bytes);
  while (connected != 0 && errno == EINTR);
  if (connected != 0) throwSocketError("no connection to the publisher's socket '" + abstract_name + "'");
  return socket;
}

bool isOfThisUser(const Descriptor& socket)
{
  ucred peer{};
  socklen_t bytes = sizeof(peer);
  return getsockopt(socket.get(), SOL_SOCKET, SO_PEERCRED, &peer, &bytes) == 0 && peer.uid == geteuid();
}

bool sendPacket(const Descriptor& socket, const void* packet, std::size_t bytes, const Descriptor& passed)
{
  iovec vector{const_cast<void*>(packet), bytes};
  Control control;
  msghdr header{};
  header.msg_iov = &vector;
  header.msg_iovlen = 1;
  if (passed)
  {
    header.msg_control = control.bytes.data();
    header.msg_controllen = control.bytes.size();
    cmsghdr* item = CMSG_FIRSTHDR(&header);
    item->cmsg_level = SOL_SOCKET;
    item->cmsg_type = SCM_RIGHTS;
    item->cmsg_len = CMSG_LEN(sizeof(int));
    const int number = passed.get();
    std::memcpy(CMSG_DATA(item), &number, sizeof(number));
  }
  ssize_t sent;
  do
    sent = sendmsg(socket.get(), &header, MSG_NOSIGNAL | MSG_DONTWAIT);
  while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(bytes);
}

Received receivePacket(const Descriptor& socket, void* packet, std::size_t bytes, Descriptor& passed, int flags)
{
  iovec vector{packet, bytes};
  Control control;
  msghdr header{};
  header.msg_iov = &vector;
  header.msg_iovlen = 1;
  header.msg_control = control.bytes.data();
  header.msg_controllen = control.bytes.size();
  ssize_t received;
  do
    received = recvmsg(socket.get(), &header, flags | MSG_CMSG_CLOEXEC);
  while (received < 0 && errno == EINTR);
  if (received < 0) return errno == EAGAIN || errno == EWOULDBLOCK ? Received::kNothing : Received::kEnded;
  std::vector<Descriptor> descriptors = passedDescriptors(header);
  if (received == 0) return Received::kEnded;
  if ((header.msg_flags & MSG_CTRUNC) != 0) return Received::kCut;
  const bool whole = received == static_cast<ssize_t>(bytes) && (header.msg_flags & MSG_TRUNC) == 0;
  if (!whole || descriptors.size() > 1) return Received::kFaulty;
  if (!descriptors.empty()) passed = std::move(descriptors.front());
  return Received::kPacket;
}

}  // namespace robot_vision
