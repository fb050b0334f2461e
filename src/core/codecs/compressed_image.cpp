#include "robot_vision/codecs/compressed_image.hpp"

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/common/starts_with.hpp"
#include "png.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

enum class Order
{
  kNone,  // stored as it is
  kBgr,
  kRgb,
  kYuv,  // stored as bgr8
};

struct Layout
{
  const char* encoding;
  int type;
  Order order;
  const char* narrow;  // the encoding with 8 bits instead of 16
};

constexpr std::array<Layout, 24> kLayouts = {{
    {"bgr8", CV_8UC3, Order::kBgr, "bgr8"},
    {"rgb8", CV_8UC3, Order::kRgb, "rgb8"},
    {"bgra8", CV_8UC4, Order::kBgr, "bgra8"},
    {"rgba8", CV_8UC4, Order::kRgb, "rgba8"},
    {"mono8", CV_8UC1, Order::kNone, "mono8"},
    {"8UC1", CV_8UC1, Order::kNone, "8UC1"},
    {"8UC3", CV_8UC3, Order::kNone, "8UC3"},
    {"bayer_rggb8", CV_8UC1, Order::kNone, "bayer_rggb8"},
    {"bayer_bggr8", CV_8UC1, Order::kNone, "bayer_bggr8"},
    {"bayer_gbrg8", CV_8UC1, Order::kNone, "bayer_gbrg8"},
    {"bayer_grbg8", CV_8UC1, Order::kNone, "bayer_grbg8"},
    {"yuv422", CV_8UC2, Order::kYuv, "bgr8"},
    {"yuv422_yuy2", CV_8UC2, Order::kYuv, "bgr8"},
    {"bgr16", CV_16UC3, Order::kBgr, "bgr8"},
    {"rgb16", CV_16UC3, Order::kRgb, "rgb8"},
    {"bgra16", CV_16UC4, Order::kBgr, "bgra8"},
    {"rgba16", CV_16UC4, Order::kRgb, "rgba8"},
    {"mono16", CV_16UC1, Order::kNone, "mono8"},
    {"16UC1", CV_16UC1, Order::kNone, "8UC1"},
    {"16UC3", CV_16UC3, Order::kNone, "8UC3"},
    {"bayer_rggb16", CV_16UC1, Order::kNone, "bayer_rggb8"},
    {"bayer_bggr16", CV_16UC1, Order::kNone, "bayer_bggr8"},
    {"bayer_gbrg16", CV_16UC1, Order::kNone, "bayer_gbrg8"},
    {"bayer_grbg16", CV_16UC1, Order::kNone, "bayer_grbg8"},
}};

Layout layoutOf(const std::string& encoding)
{
  for (const Layout& layout : kLayouts)
    if (encoding == layout.encoding) return layout;
  std::vector<std::string> known;
  for (const Layout& layout : kLayouts)
    known.emplace_back(layout.encoding);
  throw std::invalid_argument("encoding '" + printable(encoding) + "' is not one of " + joined(known));
}

bool isBayer(const Layout& layout)
{
  return startsWith(layout.encoding, "bayer");
}

/// The code of cv::cvtColor that converts from the layout to what is stored, or back; -1 if no conversion is needed.
int swapCode(const Layout& layout, bool back)
{
  if (CV_MAT_CN(layout.type) == 4)
  {
    if (layout.order == Order::kRgb) return back ? cv::COLOR_BGR2RGBA : cv::COLOR_RGBA2BGR;
    return back ? cv::COLOR_BGR2BGRA : cv::COLOR_BGRA2BGR;
  }
  return layout.order == Order::kRgb ? cv::COLOR_BGR2RGB : -1;
}

/// What the `format` of a message says.
struct Label
{
  std::string encoding;  // empty if it is not named
  bool jpeg = false;
  bool png = false;
};

Label readLabel(const std::string& format)
{
  const auto has = [](const std::string& text, const char* word) { return text.find(word) != std::string::npos; };
  const std::size_t split = format.find(';');
  const std::string codec = split == std::string::npos ? format : format.substr(split);
  Label label;
  if (split != std::string::npos) label.encoding = format.substr(0, split);
  label.jpeg = has(codec, "jpeg") || has(codec, "jpg");
  label.png = has(codec, "png");
  return label;
}

void decompressJpeg(const unsigned char* data, std::size_t size, const Layout& layout, int reduction, cv::Mat& image)
{
  const int channels = CV_MAT_CN(layout.type);
  const bool rgb = channels == 3 && layout.order == Order::kRgb;
  const JpegPixels pixels = channels == 1 ? JpegPixels::kGray : rgb ? JpegPixels::kRgb : JpegPixels::kBgr;
  if (channels != 4) return decodeJpeg(data, size, pixels, image, reduction);
  cv::Mat bgr;
  decodeJpeg(data, size, pixels, bgr, reduction);
  cv::cvtColor(bgr, image, swapCode(layout, /*back=*/true));
}

void decompressPng(const unsigned char* data, std::size_t size, const Layout& layout, int reduction, cv::Mat& image)
{
  const bool wide = CV_MAT_DEPTH(layout.type) == CV_16U;
  const int flags = CV_MAT_CN(layout.type) == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR;
  cv::Mat stored = decodePng(data, size, flags | (wide ? cv::IMREAD_ANYDEPTH : 0));
  const int code = swapCode(layout, /*back=*/true);
  if (code >= 0) cv::cvtColor(stored, stored, code);
  if (reduction > 1)
    cv::resize(stored, image, {(stored.cols + reduction - 1) / reduction, (stored.rows + reduction - 1) / reduction}, 0,
               0, cv::INTER_AREA);
  else
    image = stored;
}

/// The encoding of an image whose label does not name it.
const char* storedEncoding(bool jpeg, const unsigned char* data, std::size_t size)
{
  if (jpeg) return readJpegInfo(data, size).color ? "bgr8" : "mono8";
  const PngInfo info = readPngInfo(data, size);
  return info.color ? (info.wide ? "bgr16" : "bgr8") : (info.wide ? "mono16" : "mono8");
}

}  // namespace

void validate(const CompressionParams& params)
{
  checkFields(params);
  validate(params.jpeg);
}

std::string jpegFormat(bool color)
{
  return color ? "bgr8; jpeg compressed bgr8" : "mono8; jpeg compressed ";
}

void compress(const cv::Mat& image, const std::string& encoding, const CompressionParams& params, CompressedImage& out)
{
  validate(params);
  const bool jpeg = params.format == "jpeg";
  const Layout given = layoutOf(encoding);
  checkPixels(image, encoding, given.type);
  cv::Mat pixels = image;
  if (given.order == Order::kYuv)
    toBgr(image, encoding, pixels);
  else if (jpeg && image.depth() == CV_16U)
    image.convertTo(pixels, CV_8U, 255.0 / 65535.0);
  const Layout layout = given.order == Order::kYuv || jpeg ? layoutOf(given.narrow) : given;

  out.format = layout.encoding + ("; " + params.format) + " compressed ";
  if (layout.order != Order::kNone) out.format += CV_MAT_DEPTH(layout.type) == CV_16U ? "bgr16" : "bgr8";
  if (jpeg) return encodeJpeg(pixels, layout.order == Order::kRgb, params.jpeg, out.data);
  cv::Mat bgr = pixels;
  if (const int code = swapCode(layout, /*back=*/false); code >= 0)
  {
    bgr.release();
    cv::cvtColor(pixels, bgr, code);
  }
  encodePng(bgr, params.png_level, out.data);
}

std::string decompress(const std::string& format, const unsigned char* data, std::size_t size, ColorMode mode,
                       int reduction, cv::Mat& image)
{
  validateReduction(reduction);
  const Label label = readLabel(format);
  const bool png = isPng(data, size);
  const bool jpeg = isJpeg(data, size);
  if ((!png && !jpeg) || (png && label.jpeg) || (jpeg && label.png))
    throw std::invalid_argument("format is '" + printable(format) + "', its " + std::to_string(size) + " bytes are " +
                                (png    ? "PNG"
                                 : jpeg ? "JPEG"
                                        : "neither JPEG nor PNG"));
  const Layout stored = layoutOf(label.encoding.empty() ? storedEncoding(jpeg, data, size) : label.encoding);
  const bool narrow = jpeg || stored.order == Order::kYuv;
  Layout wanted = narrow ? layoutOf(stored.narrow) : stored;
  const bool mosaic = isBayer(wanted);
  if (mosaic && reduction != 1)
    throw std::invalid_argument("a Bayer mosaic (" + label.encoding + ") cannot be reduced");
  if (!mosaic && mode != ColorMode::kUnchanged) wanted = layoutOf(mode == ColorMode::kGray ? "mono8" : "bgr8");

  (jpeg ? decompressJpeg : decompressPng)(data, size, wanted, reduction, image);
  if (image.depth() == CV_8U) wanted = layoutOf(wanted.narrow);
  if (!mosaic || mode == ColorMode::kUnchanged) return wanted.encoding;
  const cv::Mat bayer = image;
  image.release();
  (mode == ColorMode::kGray ? toGray : toBgr)(bayer, wanted.encoding, image);
  return mode == ColorMode::kGray ? "mono8" : "bgr8";
}

}  // namespace robot_vision
