#include "robot_vision/codecs/image_file.hpp"

#include <cstdint>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <vector>

#include "image_header.hpp"
#include "opencv_codecs.hpp"
#include "png.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

/// Whether decodePng() gives the image that these flags of cv::imdecode ask for.
bool isPlain(const unsigned char* data, std::size_t size, int flags)
{
  constexpr int kPlain = cv::IMREAD_COLOR | cv::IMREAD_ANYCOLOR | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION;
  if (flags == cv::IMREAD_UNCHANGED) return true;
  return (flags & ~kPlain) == 0 && ((flags & cv::IMREAD_IGNORE_ORIENTATION) != 0 || !hasExif(data, size));
}

/// The PNG is decoded by us first, as libpng would print what is wrong with it where OpenCV decodes it.
cv::Mat decodePngFile(const unsigned char* data, std::size_t size, int flags)
{
  if (isPlain(data, size, flags)) return decodePng(data, size, flags);
  decodePng(data, size, cv::IMREAD_UNCHANGED);
  const std::vector<std::uint8_t> plain = withoutMetadata(data, size);
  return decodeByOpenCv(cv::Mat(plain), flags);
}

}  // namespace

cv::Mat decodeImageFile(const unsigned char* data, std::size_t size, int flags)
{
  const auto claimed = claimedSize(data, size);
  if (!claimed || size > static_cast<std::size_t>(std::numeric_limits<int>::max())) return {};
  requireDecodableSize("", claimed->width, claimed->height);
  try
  {
    if (isPng(data, size)) return decodePngFile(data, size, flags);
    if (isJpeg(data, size)) requireSoundJpeg(data, size);
    const cv::Mat bytes(1, static_cast<int>(size), CV_8UC1, const_cast<unsigned char*>(data));
    return decodeByOpenCv(bytes, flags);
  }
  catch (const cv::Exception& e)  // for instance because a side is longer than OpenCV allows
  {
    if (e.code == cv::Error::StsNoMem) throw;
    throw std::invalid_argument(e.err);
  }
}

}  // namespace robot_vision
