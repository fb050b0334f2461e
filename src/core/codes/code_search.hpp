#pragma once

#include <memory>

#include "robot_vision/codes/code_reader.hpp"

namespace robot_vision
{

/// zbar's scanner. For one thread at a time.
class CodeSearch
{
public:
  /// The parameters must be valid.
  explicit CodeSearch(const CodeReaderParams& params);
  ~CodeSearch();

  /// The codes in a part of a gray image; nothing of it is kept.
  std::vector<Code> find(const cv::Mat& gray, const cv::Rect& part);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
