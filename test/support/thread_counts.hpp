#pragma once

#include <opencv2/core.hpp>

/// Sets OpenCV's number of threads while it lives.
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
