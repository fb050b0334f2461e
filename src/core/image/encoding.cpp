#include "robot_vision/image/encoding.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "color_conversion.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr int kNoConversion = -1;  // instead of a code of cv::cvtColor: no conversion is needed

struct Layout
{
  const char* name;
  int type;
  int to_bgr;
  int to_rgb;
  int to_gray;
  int width_multiple;
  int height_multiple;
};

// OpenCV names a Bayer pattern by the second and third pixel of the second row, ROS by the first two of the first row.
constexpr std::array<Layout, 21> kLayouts = {{
    {"bgr8", CV_8UC3, kNoConversion, cv::COLOR_BGR2RGB, cv::COLOR_BGR2GRAY, 1, 1},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR, kNoConversion, cv::COLOR_RGB2GRAY, 1, 1},
    {"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR, cv::COLOR_BGRA2RGB, cv::COLOR_BGRA2GRAY, 1, 1},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR, cv::COLOR_RGBA2RGB, cv::COLOR_RGBA2GRAY, 1, 1},
    {"mono8", CV_8UC1, cv::COLOR_GRAY2BGR, cv::COLOR_GRAY2RGB, kNoConversion, 1, 1},
    {"mono16", CV_16UC1, cv::COLOR_GRAY2BGR, cv::COLOR_GRAY2RGB, kNoConversion, 1, 1},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2BGR_UYVY, cv::COLOR_YUV2RGB_UYVY, kNoConversion, 2, 1},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUY2, cv::COLOR_YUV2RGB_YUY2, kNoConversion, 2, 1},
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2RGB, cv::COLOR_BayerBG2GRAY, 1, 1},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2RGB, cv::COLOR_BayerRG2GRAY, 1, 1},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2RGB, cv::COLOR_BayerGR2GRAY, 1, 1},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2RGB, cv::COLOR_BayerGB2GRAY, 1, 1},
    {"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2BGR, cv::COLOR_BayerBG2RGB, cv::COLOR_BayerBG2GRAY, 1, 1},
    {"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2BGR, cv::COLOR_BayerRG2RGB, cv::COLOR_BayerRG2GRAY, 1, 1},
    {"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2BGR, cv::COLOR_BayerGR2RGB, cv::COLOR_BayerGR2GRAY, 1, 1},
    {"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2BGR, cv::COLOR_BayerGB2RGB, cv::COLOR_BayerGB2GRAY, 1, 1},
    {"mono10", CV_16UC1, cv::COLOR_GRAY2BGR, cv::COLOR_GRAY2RGB, kNoConversion, 1, 1},
    {"nv12", CV_8UC1, cv::COLOR_YUV2BGR_NV12, cv::COLOR_YUV2RGB_NV12, kNoConversion, 2, 3},
    {"nv21", CV_8UC1, cv::COLOR_YUV2BGR_NV21, cv::COLOR_YUV2RGB_NV21, kNoConversion, 2, 3},
    {"yu12", CV_8UC1, cv::COLOR_YUV2BGR_I420, cv::COLOR_YUV2RGB_I420, kNoConversion, 2, 3},
    {"jpeg", CV_8UC1, kNoConversion, kNoConversion, kNoConversion, 1, 1},
}};

// Encodings that sensor_msgs has no names for.
constexpr std::array<const char*, 5> kCameraEncodings = {"mono10", "nv12", "nv21", "yu12", "jpeg"};

struct DepthLayout
{
  const char* name;
  int type;
};

constexpr std::array<DepthLayout, 2> kDepthLayouts = {{{"16UC1", CV_16UC1}, {"32FC1", CV_32FC1}}};

/// The layout of an encoding of depths, or null if it is none.
const DepthLayout* findDepthLayout(const std::string& encoding)
{
  const auto* found = std::find_if(kDepthLayouts.begin(), kDepthLayouts.end(),
                                   [&](const DepthLayout& l) { return encoding == l.name; });
  return found == kDepthLayouts.end() ? nullptr : found;
}

/// The layout of an encoding, or null if it is unknown.
const Layout* findLayout(const std::string& encoding)
{
  const auto* found =
      std::find_if(kLayouts.begin(), kLayouts.end(), [&](const Layout& l) { return encoding == l.name; });
  return found == kLayouts.end() ? nullptr : found;
}

const Layout& layoutOf(const std::string& encoding)
{
  if (const Layout* found = findLayout(encoding)) return *found;
  throw std::invalid_argument("encoding '" + printable(encoding) + "' is not one of " + joined(encodings()));
}

std::string describe(const cv::Mat& image, const std::string& encoding)
{
  return encoding + " image of " + toText(image.size());
}

const Layout& checkedLayout(const cv::Mat& image, const std::string& encoding)
{
  const Layout& layout = layoutOf(encoding);
  checkPixels(image, encoding, layout.type);
  if (image.cols % layout.width_multiple != 0 || image.rows % layout.height_multiple != 0)
    throw std::invalid_argument(describe(image, encoding) + ": expected columns to be a multiple of " +
                                std::to_string(layout.width_multiple) + " and rows of " +
                                std::to_string(layout.height_multiple));
  return layout;
}

/// Whether all the luma comes first, followed by chroma of half the size in each direction.
bool isPlanar(const Layout& layout)
{
  return layout.height_multiple == 3;
}

/// The luma of a planar image. The matrix does not know that it is a part of a larger one, because filters would then
/// read chroma beyond its lower border.
cv::Mat lumaPlane(const cv::Mat& image)
{
  return {image.rows * 2 / 3, image.cols, CV_8UC1, image.data, image.step};
}

const unsigned char* jpegBytes(const cv::Mat& image)
{
  if (!image.isContinuous()) throw std::invalid_argument("jpeg image is not one row of bytes");
  return image.data;
}

void decode(const cv::Mat& image, JpegPixels pixels, cv::Mat& out)
{
  decodeJpeg(jpegBytes(image), image.total(), pixels, out);
}

/// The factor that scales samples of 16 bits so that white becomes `white`.
double scaleTo(double white, const std::string& encoding)
{
  return white / (encoding == "mono10" ? 1023.0 : 65535.0);
}

/// cv::cvtColor, followed by the conversion to 8 bits, which it does not do.
void convert(const cv::Mat& image, const std::string& encoding, int code, cv::Mat& out)
{
  if (image.depth() != CV_16U)
  {
    cv::cvtColor(image, out, code);
    return;
  }
  cv::Mat wide;
  cv::cvtColor(image, wide, code);
  wide.convertTo(out, CV_8U, scaleTo(255.0, encoding));
}

void toColor(const cv::Mat& image, const std::string& encoding, bool is_rgb, cv::Mat& out)
{
  const Layout& layout = checkedLayout(image, encoding);
  const int code = is_rgb ? layout.to_rgb : layout.to_bgr;
  if (encoding == "jpeg")
    decode(image, is_rgb ? JpegPixels::kRgb : JpegPixels::kBgr, out);
  else if (code == kNoConversion)
    out = image;
  else if (!convertRows(image, encoding, is_rgb, out))
    convert(image, encoding, code, out);
}

void toMono16(const cv::Mat& image, const std::string& encoding, cv::Mat& out)
{
  if (encoding != "mono10") throw std::invalid_argument("a " + encoding + " image has no 16 bits to give as mono16");
  checkedLayout(image, encoding);
  image.convertTo(out, CV_16U, scaleTo(65535.0, encoding));
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

bool isMessageEncoding(const std::string& encoding)
{
  return isEncoding(encoding) &&
         std::find(kCameraEncodings.begin(), kCameraEncodings.end(), encoding) == kCameraEncodings.end();
}

bool isDepthEncoding(const std::string& encoding)
{
  return findDepthLayout(encoding) != nullptr;
}

int matType(const std::string& encoding)
{
  const DepthLayout* depth = findDepthLayout(encoding);
  return depth != nullptr ? depth->type : layoutOf(encoding).type;
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

void checkPixels(const cv::Mat& image, const std::string& encoding, int type)
{
  if (image.empty()) throw std::invalid_argument(describe(image, encoding) + " is empty");
  if (image.type() != type)
    throw std::invalid_argument(describe(image, encoding) + ": expected pixels of " + describePixels(type) + ", got " +
                                describePixels(image.type()));
}

cv::Size imageSize(const cv::Mat& image, const std::string& encoding)
{
  if (const DepthLayout* depth = findDepthLayout(encoding))
  {
    checkPixels(image, encoding, depth->type);
    return image.size();
  }
  const Layout& layout = checkedLayout(image, encoding);
  if (encoding == "jpeg") return readJpegInfo(jpegBytes(image), image.total()).size;
  return isPlanar(layout) ? lumaPlane(image).size() : image.size();
}

void toGray(const cv::Mat& image, const std::string& encoding, cv::Mat& gray)
{
  const Layout& layout = checkedLayout(image, encoding);
  if (encoding == "jpeg")
    decode(image, JpegPixels::kGray, gray);
  else if (isPlanar(layout))
    gray = lumaPlane(image);
  else if (layout.type == CV_8UC2)
    copyLuma(image, encoding, gray);
  else if (layout.to_gray != kNoConversion)
  {
    const bool is_rgb = encoding == "rgb8" || encoding == "rgba8";
    if (!convertRowsToGray(image, is_rgb, gray)) convert(image, encoding, layout.to_gray, gray);
  }
  else if (image.depth() == CV_16U)
    image.convertTo(gray, CV_8U, scaleTo(255.0, encoding));
  else
    gray = image;
}

bool sharesPixels(const cv::Mat& converted, const cv::Mat& source)
{
  return converted.data >= source.datastart && converted.data < source.dataend;
}

void toBgr(const cv::Mat& image, const std::string& encoding, cv::Mat& bgr)
{
  toColor(image, encoding, /*is_rgb=*/false, bgr);
}

void toEncoding(const cv::Mat& image, const std::string& encoding, const std::string& wanted, cv::Mat& out)
{
  if (wanted == encoding)
  {
    if (const DepthLayout* depth = findDepthLayout(encoding))
      checkPixels(image, encoding, depth->type);
    else
      checkPixels(image, encoding);
    out = image;
  }
  else if (wanted == "bgr8" || wanted == "rgb8")
    toColor(image, encoding, wanted == "rgb8", out);
  else if (wanted == "mono8")
    toGray(image, encoding, out);
  else if (wanted == "mono16")
    toMono16(image, encoding, out);
  else
    throw std::invalid_argument("a " + encoding + " image cannot be converted to " + wanted);
}

}  // namespace robot_vision
