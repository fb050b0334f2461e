#include "robot_vision/encoding.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "robot_vision/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr int kNone = -1;  // no conversion needed

struct Layout
{
  const char* name;
  int type;
  int to_bgr;
  int to_gray;
  int width_multiple;
  int height_multiple;
};

// OpenCV names a Bayer pattern by the second row's second and third pixel, ROS by the first two of the first row.
constexpr std::array<Layout, 18> kLayouts = {{
    {"bgr8", CV_8UC3, kNone, cv::COLOR_BGR2GRAY, 1, 1},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR, cv::COLOR_RGB2GRAY, 1, 1},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR, cv::COLOR_BGRA2GRAY, 1, 1},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR, cv::COLOR_RGBA2GRAY, 1, 1},
    {"mono8", CV_8UC1, cv::COLOR_GRAY2BGR, kNone, 1, 1},
    {"mono16", CV_16UC1, cv::COLOR_GRAY2BGR, kNone, 1, 1},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2BGR_UYVY, cv::COLOR_YUV2GRAY_UYVY, 2, 1},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUY2, cv::COLOR_YUV2GRAY_YUY2, 2, 1},
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2GRAY, 1, 1},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2GRAY, 1, 1},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2GRAY, 1, 1},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2GRAY, 1, 1},
    {"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2GRAY, 1, 1},
    {"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2GRAY, 1, 1},
    {"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2GRAY, 1, 1},
    {"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2GRAY, 1, 1},
    {"nv12", CV_8UC1, cv::COLOR_YUV2BGR_NV12, kNone, 2, 3},
    {"jpeg", CV_8UC1, kNone, kNone, 1, 1},
}};

/// Null if it is unknown.
const Layout* findLayout(const std::string& encoding)
{
  const auto* found =
      std::find_if(kLayouts.begin(), kLayouts.end(), [&](const Layout& l) { return encoding == l.name; });
  return found == kLayouts.end() ? nullptr : found;
}

const Layout& layoutOf(const std::string& encoding)
{
  if (const Layout* found = findLayout(encoding)) return *found;
  std::string known;
  for (const Layout& layout : kLayouts)
    known += std::string(known.empty() ? "" : ", ") + layout.name;
  throw std::invalid_argument("encoding '" + encoding + "' is not one of " + known);
}

const Layout& checkedLayout(const cv::Mat& image, const std::string& encoding)
{
  const Layout& layout = layoutOf(encoding);
  const std::string what = encoding + " picture of " + std::to_string(image.cols) + "x" + std::to_string(image.rows);
  if (image.empty()) throw std::invalid_argument(what + " is empty");
  if (image.type() != layout.type)
    throw std::invalid_argument(what + ": expected pixels of " + describePixels(layout.type) + ", got " +
                                describePixels(image.type()));
  if (image.cols % layout.width_multiple != 0 || image.rows % layout.height_multiple != 0)
    throw std::invalid_argument(what + ": expected columns to be a multiple of " +
                                std::to_string(layout.width_multiple) + " and rows of " +
                                std::to_string(layout.height_multiple));
  return layout;
}

/// The rows above the chroma of an NV12 picture, as a header that knows of no larger picture: filters would otherwise
/// read chroma for the lower border.
cv::Mat lumaPlane(const cv::Mat& nv12)
{
  return {nv12.rows * 2 / 3, nv12.cols, CV_8UC1, nv12.data, nv12.step};
}

void decodeJpeg(const cv::Mat& bytes, int flags, cv::Mat& out)
{
  if (!bytes.isContinuous() || !isCompleteJpeg(bytes.data, bytes.total()))
    throw std::invalid_argument("JPEG of " + std::to_string(bytes.total()) + " bytes is damaged or truncated");
  cv::imdecode(bytes, flags, &out);
  if (out.empty()) throw std::invalid_argument("JPEG of " + std::to_string(bytes.total()) + " bytes cannot be decoded");
}

/// cv::cvtColor, with the 16 -> 8 bit step that it does not have.
void convert(const cv::Mat& image, int code, cv::Mat& out)
{
  if (image.depth() != CV_16U)
  {
    cv::cvtColor(image, out, code);
    return;
  }
  cv::Mat wide;
  cv::cvtColor(image, wide, code);
  wide.convertTo(out, CV_8U, 255.0 / 65535.0);
}

}  // namespace

std::vector<std::string> encodings()
{
  std::vector<std::string> names;
  for (const Layout& layout : kLayouts)
    names.emplace_back(layout.name);
  return names;
}

bool isEncoding(const std::string& encoding)
{
  return findLayout(encoding) != nullptr;
}

int matType(const std::string& encoding)
{
  return layoutOf(encoding).type;
}

std::string describePixels(int type)
{
  return std::to_string(CV_MAT_CN(type)) + " x " + std::to_string(8 * CV_ELEM_SIZE1(type)) + " bits (" +
         cv::typeToString(type) + ")";
}

void checkPixels(const cv::Mat& image, const std::string& encoding)
{
  checkedLayout(image, encoding);
}

void toGray(const cv::Mat& image, const std::string& encoding, cv::Mat& gray)
{
  const Layout& layout = checkedLayout(image, encoding);
  if (encoding == "jpeg")
    decodeJpeg(image, cv::IMREAD_GRAYSCALE, gray);
  else if (encoding == "nv12")
    gray = lumaPlane(image);
  else if (encoding == "mono16")
    image.convertTo(gray, CV_8U, 255.0 / 65535.0);
  else if (layout.to_gray == kNone)
    gray = image;
  else
    convert(image, layout.to_gray, gray);
}

bool sharesPixels(const cv::Mat& picture, const cv::Mat& source)
{
  return picture.data >= source.datastart && picture.data < source.dataend;
}

void toBgr(const cv::Mat& image, const std::string& encoding, cv::Mat& bgr)
{
  const Layout& layout = checkedLayout(image, encoding);
  if (encoding == "jpeg")
    decodeJpeg(image, cv::IMREAD_COLOR, bgr);
  else if (layout.to_bgr == kNone)
    bgr = image;
  else
    convert(image, layout.to_bgr, bgr);
}

}  // namespace robot_vision
