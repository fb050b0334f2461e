#pragma once

#include <memory>

#include "robot_vision/codes/code_reader.hpp"

namespace robot_vision
{

/// Searches images for codes with a scanner of zbar. Not thread-safe.
class CodeSearch
{
public:
  /// The parameters must be valid.
  explicit CodeSearch(const CodeReaderParams& params);
  ~CodeSearch();

  /// Finds the codes in a part of a gray image. Keeps nothing of the image.
  std::vector<Code> find(const cv::Mat& gray, const cv::Rect& part);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
