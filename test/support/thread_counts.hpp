#pragma once

#include <opencv2/core.hpp>

/// As many threads of OpenCV's as wanted, while it lives.
class ThreadCount
{
public:
  explicit ThreadCount(int count) { cv::setNumThreads(count); }
  ~ThreadCount() { cv::setNumThreads(before_); }
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;

private:
  int before_ = cv::getNumThreads();
};
