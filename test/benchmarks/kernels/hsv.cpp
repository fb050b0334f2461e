#include "robot_vision/color/hsv.hpp"

#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "robot_vision/segmentation/regions.hpp"

namespace bench
{
namespace
{

using robot_vision::HsvRange;

struct Mask : Results
{
  Mask(const Setup& setup, const HsvRange& of) : frames(setup.frames), range(of), mask(of) {}

  void byOpenCv(std::size_t i)
  {
    cv::cvtColor(frames[i], hsv, cv::COLOR_BGR2HSV);
    const bool through_red = range.h_low > range.h_high;
    cv::inRange(hsv, cv::Scalar(range.h_low, range.s_low, range.v_low),
                cv::Scalar(through_red ? 180 : range.h_high, range.s_high, range.v_high), theirs);
    if (!through_red) return;
    cv::inRange(hsv, cv::Scalar(0, range.s_low, range.v_low), cv::Scalar(range.h_high, range.s_high, range.v_high),
                rest);
    cv::bitwise_or(theirs, rest, theirs);
  }

  void byUs(std::size_t i) { mask.apply(frames[i], "bgr8", ours); }

  std::vector<cv::Mat> frames;
  HsvRange range;
  robot_vision::HsvMask mask;
  cv::Mat hsv, rest;
};

Work maskWork(const std::string& color, const HsvRange& range, bool scales)
{
  return {"HSV mask, " + color, "cvtColor, inRange", 4.0, contestOf<Mask>(range), scales};
}

/// The masks that are cleaned; outlines and numbers are only made.
struct Regions : Results
{
  Regions(const Setup& setup, const HsvRange& range)
  {
    for (const cv::Mat& frame : setup.frames)
      robot_vision::HsvMask(range).apply(frame, "bgr8", masks.emplace_back());
  }

  void byOpenCv(std::size_t i)
  {
    masks[i].copyTo(theirs);
    cv::morphologyEx(theirs, theirs, cv::MORPH_OPEN, ellipse);
    cv::morphologyEx(theirs, theirs, cv::MORPH_CLOSE, ellipse);
    cv::connectedComponentsWithStats(theirs, labels, statistics, centroids);
    cv::findContours(theirs, outlines, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  }

  void byUs(std::size_t i)
  {
    masks[i].copyTo(ours);
    finder.apply(ours);
  }

  std::vector<cv::Mat> masks;
  robot_vision::RegionFinder finder;
  cv::Mat ellipse = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  cv::Mat labels, statistics, centroids;
  std::vector<std::vector<cv::Point>> outlines;
};

Work regionWork(const std::string& color, const HsvRange& range)
{
  return {"regions of the mask, " + color, "open, close, connectedComponentsWithStats, findContours", 1.0,
          contestOf<Regions>(range)};
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
