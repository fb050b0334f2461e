#include <memory>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "core/image/histogram_equalization.hpp"
#include "robot_vision/image/encoding.hpp"

namespace bench
{
namespace
{

using Convert = void (*)(const cv::Mat&, const std::string&, cv::Mat&);

/// A picture of the encoding, without the photograph's colours: all its bytes are gray ones of the photograph.
cv::Mat encoded(const cv::Mat& bgr, const std::string& encoding)
{
  const int type = robot_vision::matType(encoding);
  const bool planar = encoding == "nv12" || encoding == "nv21" || encoding == "yu12";
  const cv::Size size(bgr.cols, planar ? bgr.rows * 3 / 2 : bgr.rows);
  cv::Mat result(size, type);
  cv::Mat bytes(size.height, size.width * static_cast<int>(result.elemSize()), CV_8UC1, result.data);
  cv::Mat gray;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  cv::resize(gray, bytes, bytes.size());
  return result;
}

struct Case
{
  const char* encoding;
  int to_bgr;
  int to_gray;
};

Work work(const std::string& encoding, const std::string& to, int code, Convert ours)
{
  struct State
  {
    std::vector<cv::Mat> frames;
    Results results;
  };
  const auto prepare = [=](const Setup& setup)
  {
    const auto state = std::make_shared<State>();
    for (const cv::Mat& frame : setup.frames)
      state->frames.push_back(encoded(frame, encoding));
    return Contest{[=](std::size_t i) { cv::cvtColor(state->frames[i], state->results.theirs, code); },
                   [=](std::size_t i) { ours(state->frames[i], encoding, state->results.ours); },
                   [=] { return state->results.same(); }};
  };
  return {encoding + " to " + to, "cvtColor", 1.0, prepare};
}

/// What faces are searched in.
Work equalizingWork(const std::string& encoding, int to_gray)
{
  struct State
  {
    std::vector<cv::Mat> frames;
    cv::Mat their_gray, our_gray;
    Results results;
  };
  const auto prepare = [=](const Setup& setup)
  {
    const auto state = std::make_shared<State>();
    for (const cv::Mat& frame : setup.frames)
      state->frames.push_back(encoded(frame, encoding));
    const auto theirs = [=](std::size_t i)
    {
      cv::cvtColor(state->frames[i], state->their_gray, to_gray);
      cv::equalizeHist(state->their_gray, state->results.theirs);
    };
    const auto ours = [=](std::size_t i)
    { robot_vision::toEqualizedGray(state->frames[i], encoding, state->our_gray, state->results.ours); };
    return Contest{theirs, ours, [=] { return state->results.same(); }};
  };
  return {encoding + " to equalised grey", "cvtColor, equalizeHist", 1.0, prepare};
}

}  // namespace

std::vector<Work> conversionWorks()
{
  const std::vector<Case> cases = {
      {"rgb8", cv::COLOR_RGB2BGR, cv::COLOR_RGB2GRAY},
      {"bgra8", cv::COLOR_BGRA2BGR, cv::COLOR_BGRA2GRAY},
      {"yuv422_yuy2", cv::COLOR_YUV2BGR_YUY2, cv::COLOR_YUV2GRAY_YUY2},
      {"yuv422", cv::COLOR_YUV2BGR_UYVY, cv::COLOR_YUV2GRAY_UYVY},
      {"nv12", cv::COLOR_YUV2BGR_NV12, cv::COLOR_YUV2GRAY_NV12},
      {"nv21", cv::COLOR_YUV2BGR_NV21, cv::COLOR_YUV2GRAY_NV21},
      {"yu12", cv::COLOR_YUV2BGR_I420, cv::COLOR_YUV2GRAY_I420},
      // OpenCV names a Bayer pattern by the second row's second and third pixel, ROS by the first two of the first row.
      {"bayer_rggb8", cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2GRAY},
      {"bayer_bggr8", cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2GRAY},
      {"bayer_gbrg8", cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2GRAY},
      {"bayer_grbg8", cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2GRAY},
  };
  std::vector<Work> works = {work("bgr8", "grey", cv::COLOR_BGR2GRAY, robot_vision::toGray),
                             equalizingWork("bgr8", cv::COLOR_BGR2GRAY),
                             equalizingWork("yuv422_yuy2", cv::COLOR_YUV2GRAY_YUY2)};
  for (const Case& c : cases)
  {
    works.push_back(work(c.encoding, "bgr8", c.to_bgr, robot_vision::toBgr));
    works.push_back(work(c.encoding, "grey", c.to_gray, robot_vision::toGray));
  }
  return works;
}

}  // namespace bench
