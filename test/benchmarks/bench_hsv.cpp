// HSV masks and their regions, ours and with OpenCV as courses teach it: bench_hsv PICTURE WIDTH HEIGHT ROUNDS
//
// Both see the same frames in turns, on one thread, and keep their memory. Prints JSON: for each range of colours the
// share of white pixels in % and medians over the rounds in ms per frame. Fails if a mask differs.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>

#include "measure.hpp"
#include "robot_vision/hsv.hpp"
#include "robot_vision/regions.hpp"

namespace
{

using robot_vision::HsvRange;

struct Case
{
  const char* name;
  HsvRange range;
};

const std::array<Case, 4> kCases = {{
    {"blue", {90, 50, 50, 120, 255, 255}},
    {"skin", {0, 35, 0, 57, 255, 255}},
    {"red", {170, 100, 100, 10, 255, 255}},
    {"half saturated", {8, 128, 40, 23, 255, 255}},  // limits that many pixels meet exactly
}};

using Times = std::vector<double>;  // ms

void measure(const std::function<void()>& work, Times& times)
{
  const double begin = bench::seconds(CLOCK_MONOTONIC);
  work();
  times.push_back((bench::seconds(CLOCK_MONOTONIC) - begin) * 1e3);
}

class ByOpenCv
{
public:
  explicit ByOpenCv(const HsvRange& range) : range_(range) {}

  void findMask(const cv::Mat& bgr, cv::Mat& mask)
  {
    cv::cvtColor(bgr, hsv_, cv::COLOR_BGR2HSV);
    const bool through_red = range_.h_low > range_.h_high;
    cv::inRange(hsv_, cv::Scalar(range_.h_low, range_.s_low, range_.v_low),
                cv::Scalar(through_red ? 180 : range_.h_high, range_.s_high, range_.v_high), mask);
    if (!through_red) return;
    cv::inRange(hsv_, cv::Scalar(0, range_.s_low, range_.v_low),
                cv::Scalar(range_.h_high, range_.s_high, range_.v_high), rest_);
    cv::bitwise_or(mask, rest_, mask);
  }

  void findRegions(cv::Mat& mask)
  {
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, ellipse_);
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, ellipse_);
    cv::connectedComponentsWithStats(mask, labels_, statistics_, centroids_);
    cv::findContours(mask, outlines_, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  }

private:
  HsvRange range_;
  cv::Mat ellipse_ = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  cv::Mat hsv_, rest_, labels_, statistics_, centroids_;
  std::vector<std::vector<cv::Point>> outlines_;
};

void run(const Case& c, const std::vector<cv::Mat>& frames, int rounds)
{
  ByOpenCv opencv(c.range);
  const robot_vision::HsvMask ours(c.range);
  const robot_vision::RegionFinder finder;
  std::array<cv::Mat, 2> masks;
  std::array<Times, 2> mask_times, region_times;
  double white = 0.0;
  bool opencv_first = true;
  for (int round = 0; round < rounds; ++round)
    for (const cv::Mat& bgr : frames)
    {
      const auto opencv_mask = [&] { measure([&] { opencv.findMask(bgr, masks[0]); }, mask_times[0]); };
      if (opencv_first) opencv_mask();
      measure([&] { ours.apply(bgr, "bgr8", masks[1]); }, mask_times[1]);
      if (!opencv_first) opencv_mask();
      opencv_first = !opencv_first;  // the second finds the picture in the cache
      if (cv::norm(masks[0], masks[1], cv::NORM_INF) != 0.0) throw std::runtime_error("the masks differ");
      white = 1e2 * cv::countNonZero(masks[0]) / static_cast<double>(masks[0].total());
      measure([&] { opencv.findRegions(masks[0]); }, region_times[0]);
      measure([&] { finder.apply(masks[1]); }, region_times[1]);
    }
  std::printf(
      "{\"name\": \"%s\", \"white\": %.3f, \"mask\": {\"opencv\": %.4f, \"ours\": %.4f}, "
      "\"regions\": {\"opencv\": %.4f, \"ours\": %.4f}}",
      c.name, white, bench::median(mask_times[0]), bench::median(mask_times[1]), bench::median(region_times[0]),
      bench::median(region_times[1]));
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc != 5) throw std::invalid_argument("bench_hsv PICTURE WIDTH HEIGHT ROUNDS");
  cv::setNumThreads(1);
  const std::vector<cv::Mat> frames = bench::movingPicture(argv[1], {std::atoi(argv[2]), std::atoi(argv[3])});
  const char* comma = "[";
  for (const Case& c : kCases)
  {
    std::printf("%s", comma);
    run(c, frames, std::max(std::atoi(argv[4]), 1));
    comma = ", ";
  }
  std::printf("]\n");
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_hsv: %s\n", e.what());
  return 1;
}
