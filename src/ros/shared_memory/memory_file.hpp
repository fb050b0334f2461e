#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "fork_count.hpp"

namespace robot_vision
{

/// Memory that a file is mapped to, until the end of this.
class Mapping
{
public:
  Mapping() = default;
  Mapping(std::uint8_t* data, std::size_t bytes) : data_(data), bytes_(bytes) {}
  ~Mapping();
  Mapping(Mapping&& other) noexcept : data_(std::exchange(other.data_, nullptr)), bytes_(std::exchange(other.bytes_, 0))
  {
  }
  Mapping& operator=(Mapping&& other) noexcept
  {
    std::swap(data_, other.data_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }

  std::uint8_t* data() const { return data_; }
  std::size_t bytes() const { return bytes_; }

private:
  std::uint8_t* data_ = nullptr;
  std::size_t bytes_ = 0;
};

/// Memory without a name that this process writes, and others that get the descriptor read.
struct MemoryFile
{
  Descriptor descriptor;  // to be given to others
  Mapping mapping;        // the only one there ever is that can be written
};

constexpr std::size_t kMaxMemoryFile = std::size_t{1} << 30;  // bytes

/// How others are kept from writing: by a seal, or, where the kernel (before 5.1) does not have it, by a descriptor
/// that is open for reading. That prevents mistakes; a process of the same user that means to can open the file anew.
enum class WriteProtection
{
  kSeal,
  kReadOnlyDescriptor
};
WriteProtection writeProtection();

/// Makes such memory, with all of its pages there already: what is touched first takes longer, and memory that is
/// missing is missed here and not by a signal later. `name` is what /proc shows. Throws SharedMemoryError.
MemoryFile makeMemoryFile(const char* name, std::size_t bytes, WriteProtection protection = writeProtection());

/// Maps another process' memory for reading. It is refused unless nothing that this process does can take away the
/// pages under the mapping: it must be a memfd of min_bytes to max_bytes, sealed against shrinking and, where
/// kernels can, against writing (with which goes punching holes), and all of its pages must be there. Throws
/// SharedMemoryError.
Mapping mapForeignMemory(const Descriptor& descriptor, std::size_t min_bytes, std::size_t max_bytes);

}  // namespace robot_vision
