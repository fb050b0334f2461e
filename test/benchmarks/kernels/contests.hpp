#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

/// What bench_kernels measures: work of ours beside the calls of OpenCV that it replaces.
namespace bench
{

/// Both sides on frame `i` of those it was made with, with memory that they keep, and whether the last results of both
/// are the same.
struct Contest
{
  std::function<void(std::size_t i)> theirs, ours;
  std::function<bool()> same;
};

/// Frames of a photograph that moves, in BGR, and how many threads may work on one.
struct Setup
{
  std::vector<cv::Mat> frames;
  int threads;
};

struct Work
{
  std::string name;
  std::string against;
  double goal;  // how many times as fast as the other ours is to be
  std::function<Contest(const Setup&)> prepare;
  bool scales = false;  // one of those whose growth with the size of the picture is looked at
};

std::vector<Work> edgeWorks();
std::vector<Work> hsvWorks();
std::vector<Work> motionWorks();
std::vector<Work> brightnessWorks();
std::vector<Work> conversionWorks();
std::vector<Work> jpegWorks();

/// Where a contest's pictures go.
struct Results
{
  cv::Mat theirs, ours;

  bool same() const { return theirs.size() == ours.size() && cv::norm(theirs, ours, cv::NORM_INF) == 0.0; }
};

}  // namespace bench
