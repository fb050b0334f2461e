#include "robot_vision/codecs/display_encoder.hpp"

#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/common/in_this_thread.hpp"
#include "png.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

constexpr int kFastPng = 1;  // level

cv::Size sizeOf(const DisplayParams& params, cv::Size image)
{
  const cv::Size size(params.width > 0 ? params.width : image.width, params.height > 0 ? params.height : image.height);
  if (static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) > kMaxPixels)
    throw std::invalid_argument("an image cannot be shown in " + toText(size) + ", the most is " +
                                std::to_string(kMaxPixels) + " pixels");
  return size;
}

void encodeDisplayed(const DisplayedImage& view, const DisplayParams& params, std::vector<std::uint8_t>& out)
{
  if (params.format == "jpeg")
  {
    JpegParams jpeg;
    jpeg.quality = params.quality;
    return encodeJpeg(view.pixels, view.rgb, jpeg, out);
  }
  cv::Mat bgr;
  if (view.pixels.channels() == 4)
    cv::cvtColor(view.pixels, bgr, view.rgb ? cv::COLOR_RGBA2BGR : cv::COLOR_BGRA2BGR);
  else if (view.rgb)
    cv::cvtColor(view.pixels, bgr, cv::COLOR_RGB2BGR);
  else
    bgr = view.pixels;
  encodePng(bgr, kFastPng, out);
}

}  // namespace

void DisplayEncoder::encode(const cv::Mat& image, const std::string& encoding, const DisplayParams& params,
                            std::vector<std::uint8_t>& out)
{
  validate(params);
  // Others work on other images meanwhile, in threads of their own.
  inThisThread([&] { encodeDisplayed(display(image, encoding, params), params, out); });
}

DisplayedImage DisplayEncoder::display(const cv::Mat& image, const std::string& encoding, const DisplayParams& params)
{
  DisplayedImage shown{converted_};
  displayImage(image, encoding, shown);
  if (!sharesPixels(shown.pixels, image)) converted_ = shown.pixels;
  const cv::Size own = shown.pixels.size();
  if (const cv::Size size = sizeOf(params, own); size != own)
  {
    const bool smaller = size.width <= own.width && size.height <= own.height;
    cv::resize(shown.pixels, resized_, size, 0.0, 0.0, smaller ? cv::INTER_AREA : cv::INTER_LINEAR);
    shown.pixels = resized_;
  }
  if (params.turned)
  {
    cv::flip(shown.pixels, turned_, -1);
    shown.pixels = turned_;
  }
  return shown;
}

}  // namespace robot_vision
