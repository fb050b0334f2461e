#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{

/// The unsigned integer with the bits of a number: int is 32 bits here, and float and double are those of IEEE 754.
template <class Number>
using BitsOf =
    std::conditional_t<sizeof(Number) == 8, std::uint64_t,
                       std::conditional_t<sizeof(Number) == 4, std::uint32_t,
                                          std::conditional_t<sizeof(Number) == 2, std::uint16_t, std::uint8_t>>>;

/// Writes numbers as little-endian bytes.
class ByteWriter
{
public:
  template <class Number>
  void add(Number number)
  {
    static_assert(std::is_arithmetic_v<Number>);
    BitsOf<Number> bits;
    std::memcpy(&bits, &number, sizeof bits);
    for (std::size_t i = 0; i < sizeof bits; ++i)
      bytes_.push_back(static_cast<std::uint8_t>(std::uint64_t{bits} >> 8 * i));
  }

  void addText(const std::string& text) { bytes_.insert(bytes_.end(), text.begin(), text.end()); }

  std::vector<std::uint8_t> take() { return std::move(bytes_); }

private:
  std::vector<std::uint8_t> bytes_;
};

/// Reads what ByteWriter writes. Throws std::invalid_argument naming `what` when the bytes end before it does.
class ByteReader
{
public:
  ByteReader(const std::uint8_t* bytes, std::size_t size, std::string what)
    : bytes_(bytes), size_(size), what_(std::move(what))
  {
  }

  template <class Number>
  void get(Number& number)
  {
    const std::uint8_t* const from = take(sizeof number);
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < sizeof number; ++i)
      sum |= std::uint64_t{from[i]} << 8 * i;
    const auto bits = static_cast<BitsOf<Number>>(sum);
    std::memcpy(&number, &bits, sizeof number);
  }

  template <class Number>
  Number next()
  {
    Number number;
    get(number);
    return number;
  }

  std::string text(std::size_t length)
  {
    const std::uint8_t* const from = take(length);
    return std::string(from, from + length);
  }

  /// The length of a list whose entries have at least `entry_size` bytes; no longer than what is left.
  template <class Number>
  std::size_t count(const char* name, std::size_t entry_size)
  {
    const std::size_t number = next<Number>();
    require(number <= (size_ - at_) / entry_size, "the number of " + std::string(name) + " of " + what_,
            static_cast<double>(number), "as many as its bytes have");
    return number;
  }

  /// All bytes have been read.
  void end() const
  {
    require(at_ == size_, "the size of " + what_, std::to_string(size_) + " bytes",
            std::to_string(at_) + " bytes: there is more after its end");
  }

private:
  const std::uint8_t* take(std::size_t count)
  {
    // No text is made where nothing is wrong: this is asked for each number of a model.
    if (count > size_ - at_)
      require(false, "the size of " + what_, std::to_string(size_) + " bytes", "larger: it ends too early");
    at_ += count;
    return bytes_ + at_ - count;
  }

  const std::uint8_t* bytes_;
  std::size_t size_;
  std::size_t at_ = 0;
  std::string what_;
};

}  // namespace robot_vision
