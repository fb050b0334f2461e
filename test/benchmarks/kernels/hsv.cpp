#include "robot_vision/color/hsv.hpp"

#include <memory>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "robot_vision/segmentation/regions.hpp"

namespace bench
{
namespace
{

using robot_vision::HsvRange;

void maskByOpenCv(const cv::Mat& bgr, const HsvRange& range, cv::Mat (&memory)[2], cv::Mat& mask)
{
  auto& [hsv, rest] = memory;
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  const bool through_red = range.h_low > range.h_high;
  cv::inRange(hsv, cv::Scalar(range.h_low, range.s_low, range.v_low),
              cv::Scalar(through_red ? 180 : range.h_high, range.s_high, range.v_high), mask);
  if (!through_red) return;
  cv::inRange(hsv, cv::Scalar(0, range.s_low, range.v_low), cv::Scalar(range.h_high, range.s_high, range.v_high), rest);
  cv::bitwise_or(mask, rest, mask);
}

Work maskWork(const std::string& color, const HsvRange& range, bool scales)
{
  struct State
  {
    std::vector<cv::Mat> frames;
    robot_vision::HsvMask mask;
    cv::Mat memory[2];
    Results results;
  };
  const auto prepare = [range](const Setup& setup)
  {
    const auto state = std::make_shared<State>(State{setup.frames, robot_vision::HsvMask(range), {}, {}});
    return Contest{[=](std::size_t i) { maskByOpenCv(state->frames[i], range, state->memory, state->results.theirs); },
                   [=](std::size_t i) { state->mask.apply(state->frames[i], "bgr8", state->results.ours); },
                   [=] { return state->results.same(); }};
  };
  return {"HSV mask, " + color, "cvtColor, inRange", 4.0, prepare, scales};
}

/// The masks that are cleaned; outlines and numbers are only made.
Work regionWork(const std::string& color, const HsvRange& range)
{
  struct State
  {
    std::vector<cv::Mat> masks;
    robot_vision::RegionFinder finder;
    cv::Mat ellipse = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
    cv::Mat labels, statistics, centroids;
    std::vector<std::vector<cv::Point>> outlines;
    Results results;
  };
  const auto prepare = [range](const Setup& setup)
  {
    const auto state = std::make_shared<State>();
    for (const cv::Mat& frame : setup.frames)
      robot_vision::HsvMask(range).apply(frame, "bgr8", state->masks.emplace_back());
    const auto theirs = [state](std::size_t i)
    {
      State& me = *state;
      cv::Mat& mask = me.results.theirs;
      me.masks[i].copyTo(mask);
      cv::morphologyEx(mask, mask, cv::MORPH_OPEN, me.ellipse);
      cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, me.ellipse);
      cv::connectedComponentsWithStats(mask, me.labels, me.statistics, me.centroids);
      cv::findContours(mask, me.outlines, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
    };
    const auto ours = [state](std::size_t i)
    {
      state->masks[i].copyTo(state->results.ours);
      state->finder.apply(state->results.ours);
    };
    return Contest{theirs, ours, [state] { return state->results.same(); }};
  };
  return {"regions of the mask, " + color, "open, close, connectedComponentsWithStats, findContours", 1.0, prepare};
}

}  // namespace

std::vector<Work> hsvWorks()
{
  const HsvRange blue{90, 50, 50, 120, 255, 255};
  const HsvRange skin{0, 35, 0, 57, 255, 255};
  return {maskWork("blue", blue, true),
          maskWork("skin", skin, false),
          maskWork("red", {170, 100, 100, 10, 255, 255}, false),
          maskWork("half saturated", {8, 128, 40, 23, 255, 255}, false),  // limits that many pixels meet exactly
          regionWork("blue", blue),
          regionWork("skin", skin)};
}

}  // namespace bench
