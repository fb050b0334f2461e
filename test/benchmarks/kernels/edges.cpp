#include "robot_vision/edges/edges.hpp"

#include <memory>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"

namespace bench
{
namespace
{

struct State
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

  void byOpenCv(const cv::Mat& frame)
  {
    cv::Mat gray = frame;
    if (frame.channels() > 1)
    {
      cv::cvtColor(frame, converted, cv::COLOR_BGR2GRAY);
      gray = converted;
    }
    cv::blur(gray, blurred, {7, 7});
    cv::Canny(blurred, results.theirs, 15.0, 30.0, 3, l2_norm);
  }

  std::vector<cv::Mat> frames;
  std::string encoding;
  bool l2_norm;
  robot_vision::EdgeDetector detector;
  cv::Mat converted, blurred;
  Results results;
};

Work work(const char* name, const char* against, bool gray, bool l2)
{
  const auto prepare = [=](const Setup& setup)
  {
    const auto state = std::make_shared<State>(setup, gray, l2);
    return Contest{[state](std::size_t i) { state->byOpenCv(state->frames[i]); },
                   [state](std::size_t i)
                   { state->detector.apply(state->frames[i], state->encoding, state->results.ours); },
                   [state] { return state->results.same(); }};
  };
  return {name, against, 3.0, prepare, !gray && !l2};
}

}  // namespace

std::vector<Work> edgeWorks()
{
  return {work("edges of bgr8", "cvtColor, blur, Canny", false, false),
          work("edges of mono8", "blur, Canny", true, false),
          work("edges of bgr8, L2 gradient", "cvtColor, blur, Canny", false, true)};
}

}  // namespace bench
