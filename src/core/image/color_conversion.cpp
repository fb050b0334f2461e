#include "color_conversion.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "bayer_kernels.hpp"
#include "gray_kernels.hpp"
#include "gray_weights.hpp"
#include "row_bands.hpp"
#include "yuv_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinPixelsPerThread = 1 << 16;  // as in cv::cvtColor

struct YuvName
{
  const char* encoding;
  YuvLayout layout;
};

constexpr std::array<YuvName, 5> kYuvNames = {{{"yuv422", YuvLayout::kUyvy},
                                               {"yuv422_yuy2", YuvLayout::kYuyv},
                                               {"nv12", YuvLayout::kUv},
                                               {"nv21", YuvLayout::kVu},
                                               {"yu12", YuvLayout::kPlanes}}};

struct BayerName
{
  const char* encoding;
  bool green_first;
  bool red_first;  // whether the first row has red and green pixels, not blue and green ones
};

constexpr std::array<BayerName, 4> kBayerNames = {{{"bayer_rggb8", false, true},
                                                   {"bayer_bggr8", false, false},
                                                   {"bayer_gbrg8", true, false},
                                                   {"bayer_grbg8", true, true}}};

/// The entry of an encoding, or null.
template <class Names>
auto find(const Names& names, const std::string& encoding)
{
  const auto* found = std::find_if(names.begin(), names.end(), [&](const auto& n) { return encoding == n.encoding; });
  return found == names.end() ? nullptr : found;
}

/// Calls work(y) for each row of an image.
template <class Work>
void forRows(const cv::Size& size, const Work& work)
{
  parallelForRows(size.height, cv::getNumThreads(), rowsOf(kMinPixelsPerThread, size.width),
                  [&](int, const cv::Range& rows)
                  {
                    for (int y = rows.start; y < rows.end; ++y)
                      work(y);
                  });
}

bool isPacked(YuvLayout layout)
{
  return layout == YuvLayout::kYuyv || layout == YuvLayout::kUyvy;
}

/// The luma and the chroma of row `y`. Each row of the matrix holds two rows of yu12's chroma planes.
YuvRow yuvRow(const cv::Mat& image, YuvLayout layout, int height, int y)
{
  YuvRow row = {image.ptr(y), nullptr, nullptr};
  const int half = y / 2;
  if (layout == YuvLayout::kPlanes)
  {
    const auto plane_row = [&](int i) { return image.ptr(height + i / 2) + (i % 2) * (image.cols / 2); };
    row.u = plane_row(half);
    row.v = plane_row(height / 2 + half);
  }
  else if (!isPacked(layout))
    row.u = image.ptr(height + half);
  return row;
}

void convertYuv(const cv::Mat& image, YuvLayout layout, bool is_rgb, cv::Mat& pixels)
{
  const auto convert = kernels<YuvKernels>().yuv;
  const int height = isPacked(layout) ? image.rows : image.rows * 2 / 3;
  pixels.create(height, image.cols, CV_8UC3);
  forRows(pixels.size(),
          [&](int y) { convert(yuvRow(image, layout, height, y), layout, image.cols / 2, is_rgb, pixels.ptr(y)); });
}

void convertBayerRow(const cv::Mat& image, const BayerName& name, bool is_rgb, int y, cv::Mat& pixels)
{
  const bool odd = y % 2 != 0;
  const bool red = name.red_first != odd;
  // The kernel begins at the second pixel of the row, which is green if the first one is not.
  const BayerRow row = {image.ptr(y - 1) + 1, image.ptr(y) + 1, image.ptr(y + 1) + 1, name.green_first == odd,
                        red != is_rgb};
  auto* to = pixels.ptr<cv::Vec3b>(y);
  kernels<BayerKernels>().bayer(row, image.cols - 2, to[1].val);
  to[0] = to[1];
  to[image.cols - 1] = to[image.cols - 2];
}

void convertBayer(const cv::Mat& image, const BayerName& name, bool is_rgb, cv::Mat& pixels)
{
  pixels.create(image.size(), CV_8UC3);
  forRows(image.size(),
          [&](int y)
          {
            if (y > 0 && y < image.rows - 1) convertBayerRow(image, name, is_rgb, y, pixels);
          });
  pixels.row(1).copyTo(pixels.row(0));
  pixels.row(image.rows - 2).copyTo(pixels.row(image.rows - 1));
}

}  // namespace

bool convertRows(const cv::Mat& image, const std::string& encoding, bool is_rgb, cv::Mat& pixels)
{
  const cv::Mat source = image;  // keeps the pixels if `pixels` is the same object as `image`
  const auto* yuv = find(kYuvNames, encoding);
  if (yuv != nullptr && kernels<YuvKernels>().yuv != nullptr && image.cols >= kMinRowPixels)
  {
    convertYuv(source, yuv->layout, is_rgb, pixels);
    return true;
  }
  const auto* bayer = find(kBayerNames, encoding);
  if (bayer != nullptr && kernels<BayerKernels>().bayer != nullptr && image.cols >= kMinRowPixels + 2 && image.rows > 2)
  {
    convertBayer(source, *bayer, is_rgb, pixels);
    return true;
  }
  return false;
}

bool convertRowsToGray(const cv::Mat& image, bool is_rgb, cv::Mat& gray)
{
  const auto convert = kernels<GrayKernels>().gray;
  if (image.channels() < 3 || convert == nullptr || grayWeightsOfBgr() == nullptr) return false;
  GrayWeights weights = *grayWeightsOfBgr();
  if (is_rgb) std::swap(weights.channels[0], weights.channels[2]);
  const cv::Mat source = image;
  gray.create(source.size(), CV_8UC1);
  forRows(source.size(), [&](int y) { convert(source.ptr(y), source.channels(), weights, source.cols, gray.ptr(y)); });
  return true;
}

void copyLuma(const cv::Mat& image, const std::string& encoding, cv::Mat& luma)
{
  const cv::Mat source = image;
  const int first = encoding == "yuv422" ? 1 : 0;
  luma.create(source.size(), CV_8UC1);
  forRows(source.size(),
          [&](int y) { kernels<YuvKernels>().every_second(source.ptr(y) + first, source.cols, luma.ptr(y)); });
}

}  // namespace robot_vision
