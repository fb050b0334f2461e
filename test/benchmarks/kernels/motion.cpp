#include <opencv2/imgproc.hpp>

#include "../measure.hpp"
#include "contests.hpp"
#include "core/motion/frame_difference.hpp"

namespace bench
{
namespace
{

const robot_vision::MotionParams kParams{};

/// Each frame is compared with the first.
struct State : Results
{
  /// Boxes wander from these places; without places all of the image moves.
  State(const Setup& setup, const std::vector<cv::Point2d>& places)
    : frames(places.empty() ? setup.frames : withBoxes(setup.frames, places))
  {
    cv::cvtColor(frames.front(), background.gray, cv::COLOR_BGR2GRAY);
    background.blurred = robot_vision::blurred(background.gray, kParams.blur_size);
  }

  void byOpenCv(std::size_t i)
  {
    cv::cvtColor(frames[i], gray, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(gray, blurred, {kParams.blur_size, kParams.blur_size}, 0.0);
    cv::absdiff(blurred, background.blurred, difference);
    cv::threshold(difference, theirs, kParams.threshold, 255.0, cv::THRESH_BINARY);
    cv::dilate(theirs, theirs, cv::Mat(), {-1, -1}, kParams.dilate);
  }

  void byUs(std::size_t i)
  {
    ours.create(frames[i].size(), CV_8UC1);
    changed.find({frames[i], "bgr8"}, background, kParams, ours);
  }

  std::vector<cv::Mat> frames;
  robot_vision::Reference background;
  robot_vision::FrameDifference changed;
  cv::Mat gray, blurred, difference;
};

Work work(const char* name, const std::vector<cv::Point2d>& places)
{
  return {name, "cvtColor, GaussianBlur, absdiff, threshold, dilate", 3.0, contestOf<State>(places), places.empty()};
}

}  // namespace

std::vector<Work> motionWorks()
{
  return {work("motion, all of the image moves", {}), work("motion, a box moves", {{0.25, 0.33}}),
          work("motion, two boxes in opposite corners move", {{0.02, 0.02}, {0.6, 0.8}})};
}

}  // namespace bench
