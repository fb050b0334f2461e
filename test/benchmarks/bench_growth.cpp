// What a frame costs when there is more and more to find in it: bench_growth IMAGE FACE KIND WIDTH HEIGHT NUMBER...
//
// KIND faces: the photograph FACE as often as the number says, found and followed by FaceDetector, its searches in the
// same thread; objects: blue discs, found by HsvMask and RegionFinder. All moves before IMAGE, which has neither, at
// 30 Hz. Prints JSON, for each number: it, the CPU time of a frame (mean) in ms, and how many were found (median).

#include <cstdlib>
#include <functional>
#include <memory>

#include "measure.hpp"
#include "robot_vision/color/hsv.hpp"
#include "robot_vision/faces/face_detector.hpp"
#include "robot_vision/segmentation/regions.hpp"

namespace
{

constexpr int kFrames = 60;
constexpr double kStep = 1.0 / 30.0;  // s

/// Takes the frame of a time (s) and tells how many it has found.
using Find = std::function<std::size_t(double time_s, const cv::Mat& bgr)>;

void draw(cv::Mat& bgr, const cv::Mat& face, cv::Rect place)
{
  if (!face.empty())
    cv::resize(face, bgr(place), place.size(), 0, 0, cv::INTER_AREA);
  else
    cv::circle(bgr, (place.tl() + place.br()) / 2, place.width / 4, {200, 60, 20}, cv::FILLED);
}

/// Each thing goes round in a field of its own; fields are as many as the largest number needs, so that all numbers
/// have things of one size.
std::vector<cv::Mat> makeFrames(const std::string& image, const cv::Mat& face, cv::Size size, int number, int largest)
{
  const int columns = cvCeil(std::sqrt(largest * size.width / static_cast<double>(size.height)));
  const int rows = std::max(cvCeil(largest / static_cast<double>(columns)), 1);
  const cv::Size field(size.width / std::max(columns, 1), size.height / rows);
  const int side = std::min(field.width, field.height) * 9 / 10;
  const double radius = side / 20.0;
  const std::vector<cv::Mat> behind = bench::movingImage(image, size);
  std::vector<cv::Mat> frames;
  for (int i = 0; i < kFrames; ++i)
  {
    cv::Mat frame = behind[static_cast<std::size_t>(std::abs(i % 14 - 7))].clone();
    const cv::Point shift(cvRound(radius * std::cos(i * 0.2)), cvRound(radius * std::sin(i * 0.2)));
    const cv::Point middle((field.width - side) / 2, (field.height - side) / 2);
    for (int k = 0; k < number; ++k)
    {
      const cv::Point corner(k % columns * field.width, k / columns * field.height);
      const cv::Rect place(corner + middle + shift, cv::Size(side, side));
      draw(frame, face, place & cv::Rect({0, 0}, size));
    }
    frames.push_back(frame);
  }
  return frames;
}

Find finder(bool faces)
{
  if (faces)
  {
    robot_vision::FaceParams params;
    params.background = false;
    const auto detector = std::make_shared<robot_vision::FaceDetector>(params);
    return [detector](double time_s, const cv::Mat& bgr) { return detector->update(time_s, bgr, "bgr8").size(); };
  }
  robot_vision::RegionParams params;
  params.min_area = 50.0;
  const robot_vision::RegionFinder regions(params);
  const robot_vision::HsvMask mask({100, 200, 100, 120, 255, 255});
  return [=, pixels = cv::Mat()](double, const cv::Mat& bgr) mutable
  {
    mask.apply(bgr, "bgr8", pixels);
    return regions.apply(pixels).size();
  };
}

void run(const std::vector<cv::Mat>& frames, bool faces, int number)
{
  const Find find = finder(faces);
  find(-kStep, frames.front());  // memory, and what is searched for the first time
  std::vector<double> found;
  const double begin = bench::seconds(CLOCK_PROCESS_CPUTIME_ID);
  for (std::size_t i = 0; i < frames.size(); ++i)
    found.push_back(static_cast<double>(find(static_cast<double>(i) * kStep, frames[i])));
  const double cpu_ms = (bench::seconds(CLOCK_PROCESS_CPUTIME_ID) - begin) * 1e3 / static_cast<double>(frames.size());
  std::printf("[%d, %.4f, %.0f]", number, cpu_ms, bench::median(found));
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc < 7) throw std::invalid_argument("bench_growth IMAGE FACE KIND WIDTH HEIGHT NUMBER...");
  cv::setNumThreads(1);
  const bool faces = std::string(argv[3]) == "faces";
  const cv::Mat face = faces ? cv::imread(argv[2], cv::IMREAD_COLOR) : cv::Mat();
  if (faces && face.empty()) throw std::runtime_error(std::string(argv[2]) + " is not an image");
  std::vector<int> numbers;
  for (int i = 6; i < argc; ++i)
    numbers.push_back(std::atoi(argv[i]));
  const int largest = *std::max_element(numbers.begin(), numbers.end());
  const char* comma = "[";
  for (const int number : numbers)
  {
    const cv::Size size(std::atoi(argv[4]), std::atoi(argv[5]));
    std::printf("%s", comma);
    run(makeFrames(argv[1], face, size, number, largest), faces, number);
    comma = ", ";
  }
  std::printf("]\n");
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_growth: %s\n", e.what());
  return 1;
}
