#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

/// What bench_kernels measures: work of ours beside the calls of OpenCV, or the plain loops, that it replaces.
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
  bool scales = false;  // one of those whose growth with the size of the image is looked at
};

std::vector<Work> edgeWorks();
std::vector<Work> faceWorks();
std::vector<Work> filterWorks();
std::vector<Work> hsvWorks();
std::vector<Work> meshWorks();
std::vector<Work> motionWorks();
std::vector<Work> brightnessWorks();
std::vector<Work> conversionWorks();
std::vector<Work> depthWorks();
std::vector<Work> jpegWorks();
std::vector<Work> normalWorks();
std::vector<Work> sceneWorks();
std::vector<Work> tabletopWorks();

/// Where a contest's images go.
struct Results
{
  cv::Mat theirs, ours;

  bool same() const { return theirs.size() == ours.size() && cv::norm(theirs, ours, cv::NORM_INF) == 0.0; }
};

/// Makes contests with a State(setup, arguments...), which has both sides as byOpenCv(i) and byUs(i), and same().
template <class State, class... Arguments>
std::function<Contest(const Setup&)> contestOf(const Arguments&... arguments)
{
  return [=](const Setup& setup)
  {
    const auto state = std::make_shared<State>(setup, arguments...);
    return Contest{[state](std::size_t i) { state->byOpenCv(i); }, [state](std::size_t i) { state->byUs(i); },
                   [state] { return state->same(); }};
  };
}

}  // namespace bench
