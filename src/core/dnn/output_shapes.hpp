#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "robot_vision/dnn/head_decoder.hpp"

namespace robot_vision
{

/// Rows of an output, without gaps.
struct OutputRows
{
  const float* values = nullptr;
  std::size_t rows = 0;
  std::size_t columns = 0;

  const float* row(std::size_t i) const { return values + i * columns; }
};

/// The outputs of a head, which are checked when they are read.
class HeadOutputs
{
public:
  HeadOutputs(std::string head, const std::vector<NetworkOutput>& outputs);

  std::size_t count() const { return outputs_.size(); }

  /// Throws std::invalid_argument unless there are so many outputs.
  void requireCount(std::size_t count) const;

  /// An axis that may have any length in a shape that is expected.
  static constexpr std::int64_t kAny = -1;

  /// An output of `shape`, before which there may be axes of length 1; its last axis, or what follows of it from its
  /// second axis on, are the columns. Throws std::invalid_argument naming the head, the shape seen and the one
  /// expected, with a leading 1, unless it is of that.
  OutputRows rows(std::size_t output, const std::vector<std::int64_t>& shape) const;

  /// Throws the same error.
  [[noreturn]] void refuse(std::size_t output, const std::string& expected) const;

  /// The lengths of the last axes of an output, `axes` of them, before which there may be axes of length 1; empty if it
  /// is not of that.
  std::vector<std::int64_t> lastAxes(std::size_t output, std::size_t axes) const;

private:
  std::string head_;
  const std::vector<NetworkOutput>& outputs_;
};

}  // namespace robot_vision
