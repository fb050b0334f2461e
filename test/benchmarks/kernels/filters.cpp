#include <functional>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "robot_vision/filters/filter_chain.hpp"

namespace bench
{
namespace
{

using robot_vision::ParamValues;

/// An operation of the node `filter` on bgr8 or mono8.
struct State : Results
{
  using Function = std::function<void(const cv::Mat& frame, cv::Mat& out)>;

  State(const Setup& setup, const std::string& operation, const ParamValues& values, const std::string& layout,
        Function by)
    : frames(setup.frames), encoding(layout), by_opencv(std::move(by)), chain({operation}, values)
  {
    if (encoding != "mono8") return;
    for (cv::Mat& frame : frames)
    {
      cv::Mat gray;
      cv::cvtColor(frame, gray, cv::COLOR_BGR2GRAY);
      frame = gray;
    }
  }

  void byOpenCv(std::size_t i) { by_opencv(frames[i], theirs); }
  void byUs(std::size_t i) { chain.apply({frames[i], encoding}, ours); }

  std::vector<cv::Mat> frames;
  std::string encoding;
  Function by_opencv;
  robot_vision::FilterChain chain;
};

Work work(const std::string& name, const char* against, double goal, const std::string& operation,
          const ParamValues& values, const std::string& encoding, const State::Function& theirs)
{
  return {name, against, goal, contestOf<State>(operation, values, encoding, theirs)};
}

Work median(int size, double goal)
{
  return work("median of " + std::to_string(size) + " px, bgr8", "medianBlur", goal, "median", {{"median_size", size}},
              "bgr8", [size](const cv::Mat& frame, cv::Mat& out) { cv::medianBlur(frame, out, size); });
}

Work sobel(int size, double goal)
{
  return work("Sobel of " + std::to_string(size) + " px, bgr8", "Sobel, convertScaleAbs", goal, "sobel",
              {{"sobel_size", size}}, "bgr8",
              [size](const cv::Mat& frame, cv::Mat& out)
              {
                cv::Mat derivative;
                cv::Sobel(frame, derivative, CV_16S, 1, 0, size);
                cv::convertScaleAbs(derivative, out);
              });
}

Work scharr(double goal)
{
  return work("Scharr, bgr8", "Scharr, convertScaleAbs", goal, "scharr", {}, "bgr8",
              [](const cv::Mat& frame, cv::Mat& out)
              {
                cv::Mat derivative;
                cv::Scharr(frame, derivative, CV_16S, 1, 0);
                cv::convertScaleAbs(derivative, out);
              });
}

Work gaussian(int size, const std::string& encoding, double goal)
{
  return work("Gaussian of " + std::to_string(size) + " px, " + encoding, "GaussianBlur", goal, "gaussian",
              {{"gaussian_size", size}}, encoding,
              [size](const cv::Mat& frame, cv::Mat& out) {
                cv::GaussianBlur(frame, out, {size, size}, 0.0);
              });
}

Work halved(const std::string& encoding, double goal)
{
  return work("half the size, " + encoding, "pyrDown", goal, "pyramid_down", {}, encoding,
              [](const cv::Mat& frame, cv::Mat& out) { cv::pyrDown(frame, out); });
}

}  // namespace

std::vector<Work> filterWorks()
{
  return {median(7, 4.0),
          median(9, 2.0),
          median(11, 1.5),
          work("box of 5 px, bgr8", "blur", 2.0, "box", {}, "bgr8",
               [](const cv::Mat& frame, cv::Mat& out) {
                 cv::blur(frame, out, {5, 5});
               }),
          sobel(3, 1.5),
          sobel(5, 3.0),
          scharr(1.5),
          gaussian(5, "mono8", 1.5),
          gaussian(15, "mono8", 1.5),
          gaussian(5, "bgr8", 1.5),
          gaussian(15, "bgr8", 1.5),
          halved("mono8", 1.5),
          halved("bgr8", 1.5),
          work("adaptive threshold, mean of 11 px", "adaptiveThreshold", 2.0, "adaptive_threshold",
               {{"adaptive_threshold_mean", std::string("mean")}}, "mono8",
               [](const cv::Mat& frame, cv::Mat& out)
               { cv::adaptiveThreshold(frame, out, 255.0, cv::ADAPTIVE_THRESH_MEAN_C, cv::THRESH_BINARY, 11, 2.0); }),
          work("CLAHE, 8x8 tiles", "CLAHE", 1.5, "clahe", {}, "mono8",
               [](const cv::Mat& frame, cv::Mat& out) {
                 cv::createCLAHE(2.0, {8, 8})->apply(frame, out);
               })};
}

}  // namespace bench
