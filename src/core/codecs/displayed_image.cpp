#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "robot_vision/codecs/display_encoder.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

enum class Kind
{
  kPixels,  // shown as they are
  kWide,    // 16 bits of colour
  kDepths,
  kLabels,
};

struct Layout
{
  const char* encoding;
  int type;
  Kind kind;
  bool rgb = false;
};

/// What is not shown as toBgr() and toGray() have it.
constexpr std::array<Layout, 18> kLayouts = {{
    {"bgr8", CV_8UC3, Kind::kPixels},
    {"rgb8", CV_8UC3, Kind::kPixels, true},
    {"bgra8", CV_8UC4, Kind::kPixels},
    {"rgba8", CV_8UC4, Kind::kPixels, true},
    {"mono8", CV_8UC1, Kind::kPixels},
    {"8UC1", CV_8UC1, Kind::kPixels},
    {"8UC3", CV_8UC3, Kind::kPixels},
    {"8UC4", CV_8UC4, Kind::kPixels},
    {"bgr16", CV_16UC3, Kind::kWide},
    {"rgb16", CV_16UC3, Kind::kWide, true},
    {"bgra16", CV_16UC4, Kind::kWide},
    {"rgba16", CV_16UC4, Kind::kWide, true},
    {"16UC1", CV_16UC1, Kind::kDepths},
    {"32FC1", CV_32FC1, Kind::kDepths},
    {"64FC1", CV_64FC1, Kind::kDepths},
    {"8SC1", CV_8SC1, Kind::kLabels},
    {"16SC1", CV_16SC1, Kind::kLabels},
    {"32SC1", CV_32SC1, Kind::kLabels},
}};

const Layout* findLayout(const std::string& encoding)
{
  const auto* found =
      std::find_if(kLayouts.begin(), kLayouts.end(), [&](const Layout& l) { return encoding == l.encoding; });
  return found == kLayouts.end() ? nullptr : found;
}

[[noreturn]] void refuse(const std::string& encoding)
{
  std::vector<std::string> known = encodings();
  known.erase(std::remove_if(known.begin(), known.end(), [](const std::string& e) { return !isMessageEncoding(e); }),
              known.end());
  for (const Layout& layout : kLayouts)
    if (!isEncoding(layout.encoding)) known.emplace_back(layout.encoding);
  throw std::invalid_argument("encoding '" + printable(encoding) + "' cannot be shown, must be one of " +
                              joined(known));
}

constexpr int kWhiteMm = static_cast<int>(kWhiteDepth * 1000.0);
using DepthGrays = std::array<std::uint8_t, kWhiteMm + 1>;  // by mm

const DepthGrays& depthGrays()
{
  static const DepthGrays grays = []
  {
    DepthGrays made{};
    for (int mm = 0; mm <= kWhiteMm; ++mm)
      made[mm] = static_cast<std::uint8_t>(std::lround(255.0 * std::sqrt(static_cast<double>(mm) / kWhiteMm)));
    return made;
  }();
  return grays;
}

/// `scale` makes mm of the samples. NaN, and what is not above 0, is none.
template <class Sample>
void showDepths(const cv::Mat& depths, float scale, cv::Mat& gray)
{
  const DepthGrays& grays = depthGrays();
  gray.create(depths.size(), CV_8UC1);
  for (int y = 0; y < depths.rows; ++y)
  {
    const auto* from = depths.ptr<Sample>(y);
    auto* to = gray.ptr<std::uint8_t>(y);
    for (int x = 0; x < depths.cols; ++x)
    {
      const auto mm = static_cast<float>(from[x]) * scale;
      to[x] = grays[mm > 0.0F ? static_cast<std::size_t>(std::min(mm, static_cast<float>(kWhiteMm))) : 0];
    }
  }
}

constexpr int kLabelColors = 256;

/// Colors of labels, whose hues are as far from each other as those of all before: 0 is black, the last one gray.
const std::array<cv::Vec3b, kLabelColors + 1>& labelColors()
{
  static const std::array<cv::Vec3b, kLabelColors + 1> colors = []
  {
    constexpr double kGoldenRatio = 0.6180339887498949;
    cv::Mat hsv(1, kLabelColors, CV_8UC3);
    for (int i = 0; i < kLabelColors; ++i)
      hsv.at<cv::Vec3b>(i) = cv::Vec3b(static_cast<uchar>(180.0 * std::fmod(i * kGoldenRatio, 1.0)),
                                       static_cast<uchar>(i % 2 == 0 ? 255 : 160), 255);
    cv::cvtColor(hsv, hsv, cv::COLOR_HSV2BGR);
    std::array<cv::Vec3b, kLabelColors + 1> made;
    std::copy(hsv.begin<cv::Vec3b>(), hsv.end<cv::Vec3b>(), made.begin());
    made[0] = {0, 0, 0};
    made[kLabelColors] = {128, 128, 128};
    return made;
  }();
  return colors;
}

template <class Sample>
void showLabels(const cv::Mat& labels, cv::Mat& bgr)
{
  const auto& colors = labelColors();
  bgr.create(labels.size(), CV_8UC3);
  for (int y = 0; y < labels.rows; ++y)
  {
    const auto* from = labels.ptr<Sample>(y);
    auto* to = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < labels.cols; ++x)
    {
      const int label = from[x];
      // What comes after the last color begins again at the first that is not black.
      to[x] = colors[label < 0 ? kLabelColors : label == 0 ? 0 : 1 + (label - 1) % (kLabelColors - 1)];
    }
  }
}

void showLabels(const cv::Mat& labels, cv::Mat& bgr)
{
  switch (labels.depth())
  {
    case CV_8S:
      return showLabels<std::int8_t>(labels, bgr);
    case CV_16S:
      return showLabels<std::int16_t>(labels, bgr);
    case CV_16U:
      return showLabels<std::uint16_t>(labels, bgr);
    default:
      return showLabels<std::int32_t>(labels, bgr);
  }
}

void showDepths(const cv::Mat& depths, cv::Mat& gray)
{
  constexpr float kMmPerM = 1000.0F;
  if (depths.depth() == CV_16U) return showDepths<std::uint16_t>(depths, 1.0F, gray);
  if (depths.depth() == CV_32F) return showDepths<float>(depths, kMmPerM, gray);
  return showDepths<double>(depths, kMmPerM, gray);
}

/// Whether no pixel has more than 8 bits.
bool isNarrow(const cv::Mat& wide)
{
  for (int y = 0; y < wide.rows; ++y)
  {
    const auto* row = wide.ptr<std::uint16_t>(y);
    std::uint16_t bits = 0;
    for (int x = 0; x < wide.cols; ++x)
      bits |= row[x];
    if (bits > std::numeric_limits<std::uint8_t>::max()) return false;
  }
  return true;
}

void showEncoding(const cv::Mat& image, const std::string& encoding, cv::Mat& pixels)
{
  checkPixels(image, encoding);
  if (encoding != "mono16") return toBgr(image, encoding, pixels);
  if (isNarrow(image)) return showLabels(image, pixels);
  toGray(image, encoding, pixels);
}

}  // namespace

void displayImage(const cv::Mat& image, const std::string& encoding, DisplayedImage& view)
{
  const Layout* layout = findLayout(encoding);
  if (layout == nullptr && !isMessageEncoding(encoding)) refuse(encoding);
  view.rgb = layout != nullptr && layout->rgb;
  if (layout == nullptr) return showEncoding(image, encoding, view.pixels);
  checkPixels(image, encoding, layout->type);
  switch (layout->kind)
  {
    case Kind::kPixels:
      view.pixels = image;
      break;
    case Kind::kWide:
      image.convertTo(view.pixels, CV_8U, 255.0 / 65535.0);
      break;
    case Kind::kDepths:
      showDepths(image, view.pixels);
      break;
    case Kind::kLabels:
      showLabels(image, view.pixels);
      break;
  }
}

}  // namespace robot_vision
