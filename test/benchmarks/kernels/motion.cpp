#include <memory>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "core/motion/frame_difference.hpp"

namespace bench
{
namespace
{

const robot_vision::MotionParams kParams{};

/// Each frame is compared with the first.
struct State
{
  explicit State(const std::vector<cv::Mat>& pictures) : frames(pictures)
  {
    cv::cvtColor(frames.front(), background.gray, cv::COLOR_BGR2GRAY);
    background.blurred = robot_vision::blurred(background.gray, kParams.blur_size);
  }

  void byOpenCv(const cv::Mat& frame)
  {
    cv::cvtColor(frame, gray, cv::COLOR_BGR2GRAY);
    cv::GaussianBlur(gray, blurred, {kParams.blur_size, kParams.blur_size}, 0.0);
    cv::absdiff(blurred, background.blurred, difference);
    cv::threshold(difference, results.theirs, kParams.threshold, 255.0, cv::THRESH_BINARY);
    cv::dilate(results.theirs, results.theirs, cv::Mat(), {-1, -1}, kParams.dilate);
  }

  void byUs(const cv::Mat& frame)
  {
    results.ours.create(frame.size(), CV_8UC1);
    changed.find({frame, "bgr8"}, background, kParams, results.ours);
  }

  std::vector<cv::Mat> frames;
  robot_vision::Reference background;
  robot_vision::FrameDifference changed;
  cv::Mat gray, blurred, difference;
  Results results;
};

/// Before a camera that stands still: parts of the first frame as boxes that wander from these places (shares of the
/// frame's size), and pixel noise.
std::vector<cv::Mat> withBoxes(const std::vector<cv::Mat>& moving, const std::vector<cv::Point2d>& places)
{
  const cv::Mat& behind = moving.front();
  const cv::Size box = behind.size() / 6;
  std::vector<cv::Mat> frames;
  cv::RNG random(1);
  for (std::size_t i = 0; i < moving.size(); ++i)
  {
    cv::Mat frame = behind.clone();
    for (const cv::Point2d& place : places)
    {
      const int moved = static_cast<int>(i) * frame.cols / 32;
      const cv::Point at(cvRound(place.x * frame.cols) + moved, cvRound(place.y * frame.rows));
      behind(cv::Rect({frame.cols / 2, frame.rows / 2}, box)).copyTo(frame(cv::Rect(at, box)));
    }
    cv::Mat noise(frame.size(), CV_16SC3);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    cv::add(frame, noise, frames.emplace_back(), cv::noArray(), CV_8U);
  }
  return frames;
}

/// Without places all of the picture moves.
Work work(const char* name, const std::vector<cv::Point2d>& places)
{
  const auto prepare = [places](const Setup& setup)
  {
    const auto state = std::make_shared<State>(places.empty() ? setup.frames : withBoxes(setup.frames, places));
    return Contest{[state](std::size_t i) { state->byOpenCv(state->frames[i]); },
                   [state](std::size_t i) { state->byUs(state->frames[i]); },
                   [state] { return state->results.same(); }};
  };
  return {name, "cvtColor, GaussianBlur, absdiff, threshold, dilate", 3.0, prepare, places.empty()};
}

}  // namespace

std::vector<Work> motionWorks()
{
  return {work("motion, all of the picture moves", {}), work("motion, a box moves", {{0.25, 0.33}}),
          work("motion, two boxes in opposite corners move", {{0.02, 0.02}, {0.6, 0.8}})};
}

}  // namespace bench
