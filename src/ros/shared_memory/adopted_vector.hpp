#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace robot_vision
{

#ifdef ROBOT_VISION_ADOPTS_VECTORS

/// Has a std::vector stand on memory that is not its own, while this exists: without a copy, and without any
/// allocation. The vector must be empty, may be read and copied as any other, and must neither grow, move nor be
/// swapped meanwhile: as a member of a message that is const it cannot. Declare this behind the vector, so that it ends
/// before it.
///
/// The standard has no such thing. It relies on the three pointers that std::vector consists of in libstdc++, which a
/// struct that is derived from it may name; CMake finds out whether this works, and defines ROBOT_VISION_ADOPTS_VECTORS
/// then. Elsewhere the bytes are copied, and the rest is the same.
class AdoptedVector
{
public:
  AdoptedVector(std::vector<std::uint8_t>& vector, const std::uint8_t* data, std::size_t bytes) : vector_(vector)
  {
    std::vector<std::uint8_t>().swap(vector_);  // it may have some capacity
    auto* begin = const_cast<std::uint8_t*>(data);
    Pointers::set(vector_, begin, begin + bytes);
  }
  ~AdoptedVector() { Pointers::set(vector_, nullptr, nullptr); }
  AdoptedVector(const AdoptedVector&) = delete;
  AdoptedVector& operator=(const AdoptedVector&) = delete;

  static constexpr bool kCopies = false;

private:
  struct Pointers : std::vector<std::uint8_t>
  {
    static void set(std::vector<std::uint8_t>& vector, std::uint8_t* begin, std::uint8_t* end)
    {
      auto& implementation = vector.*&Pointers::_M_impl;
      implementation._M_start = begin;
      implementation._M_finish = end;
      implementation._M_end_of_storage = end;
    }
  };

  std::vector<std::uint8_t>& vector_;
};

#else

/// Has a std::vector hold a copy of these bytes, where it cannot stand on them.
class AdoptedVector
{
public:
  AdoptedVector(std::vector<std::uint8_t>& vector, const std::uint8_t* data, std::size_t bytes)
  {
    vector.assign(data, data + bytes);
  }
  AdoptedVector(const AdoptedVector&) = delete;
  AdoptedVector& operator=(const AdoptedVector&) = delete;

  static constexpr bool kCopies = true;
};

#endif

}  // namespace robot_vision
