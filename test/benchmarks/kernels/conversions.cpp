#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "core/image/histogram_equalization.hpp"
#include "robot_vision/image/encoding.hpp"

namespace bench
{
namespace
{

using Convert = void (*)(const cv::Mat&, const std::string&, cv::Mat&);

/// An image of the encoding, without the photograph's colors: all its bytes are gray ones of the photograph.
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

struct Encoded : Results
{
  Encoded(const Setup& setup, const std::string& of, int to) : encoding(of), code(to)
  {
    for (const cv::Mat& frame : setup.frames)
      frames.push_back(encoded(frame, encoding));
  }

  std::string encoding;
  int code;
  std::vector<cv::Mat> frames;
};

struct Conversion : Encoded
{
  Conversion(const Setup& setup, const std::string& of, int to, Convert by) : Encoded(setup, of, to), convert(by) {}

  void byOpenCv(std::size_t i) { cv::cvtColor(frames[i], theirs, code); }
  void byUs(std::size_t i) { convert(frames[i], encoding, ours); }

  Convert convert;
};

Work work(const std::string& encoding, const std::string& to, int code, Convert ours)
{
  return {encoding + " to " + to, "cvtColor", 1.0, contestOf<Conversion>(encoding, code, ours)};
}

/// What faces are searched in.
struct Equalizing : Encoded
{
  using Encoded::Encoded;

  void byOpenCv(std::size_t i)
  {
    cv::cvtColor(frames[i], their_gray, code);
    cv::equalizeHist(their_gray, theirs);
  }

  void byUs(std::size_t i) { robot_vision::toEqualizedGray(frames[i], encoding, our_gray, ours); }

  cv::Mat their_gray, our_gray;
};

Work equalizingWork(const std::string& encoding, int code)
{
  return {encoding + " to equalized gray", "cvtColor, equalizeHist", 1.0, contestOf<Equalizing>(encoding, code)};
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
  std::vector<Work> works = {work("bgr8", "gray", cv::COLOR_BGR2GRAY, robot_vision::toGray),
                             equalizingWork("bgr8", cv::COLOR_BGR2GRAY),
                             equalizingWork("yuv422_yuy2", cv::COLOR_YUV2GRAY_YUY2)};
  for (const Case& c : cases)
  {
    works.push_back(work(c.encoding, "bgr8", c.to_bgr, robot_vision::toBgr));
    works.push_back(work(c.encoding, "gray", c.to_gray, robot_vision::toGray));
  }
  return works;
}

}  // namespace bench
