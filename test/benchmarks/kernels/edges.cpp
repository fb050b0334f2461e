#include "robot_vision/edges/edges.hpp"

#include <opencv2/imgproc.hpp>

#include "contests.hpp"

namespace bench
{
namespace
{

struct State : Results
{
  State(const Setup& setup, bool gray, bool l2) : frames(setup.frames), encoding(gray ? "mono8" : "bgr8"), l2_norm(l2)
  {
    robot_vision::EdgeParams params;
    params.l2_gradient = l2;
    params.threads = setup.threads;
    detector = robot_vision::EdgeDetector(params);
    if (!gray) return;
    for (cv::Mat& frame : frames)
      cv::cvtColor(frame.clone(), frame, cv::COLOR_BGR2GRAY);
  }

  void byOpenCv(std::size_t i)
  {
    cv::Mat gray = frames[i];
    if (gray.channels() > 1)
    {
      cv::cvtColor(frames[i], converted, cv::COLOR_BGR2GRAY);
      gray = converted;
    }
    cv::blur(gray, blurred, {7, 7});
    cv::Canny(blurred, theirs, 15.0, 30.0, 3, l2_norm);
  }

  void byUs(std::size_t i) { detector.apply(frames[i], encoding, ours); }

  std::vector<cv::Mat> frames;
  std::string encoding;
  bool l2_norm;
  robot_vision::EdgeDetector detector;
  cv::Mat converted, blurred;
};

Work work(const char* name, const char* against, bool gray, bool l2)
{
  return {name, against, 3.0, contestOf<State>(gray, l2), !gray && !l2};
}

}  // namespace

std::vector<Work> edgeWorks()
{
  return {work("edges of bgr8", "cvtColor, blur, Canny", false, false),
          work("edges of mono8", "blur, Canny", true, false),
          work("edges of bgr8, L2 gradient", "cvtColor, blur, Canny", false, true)};
}

}  // namespace bench
