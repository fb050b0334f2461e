#include <stdexcept>

#include "image_header.hpp"
#include "png.hpp"
#include "robot_vision/codecs/compressed_image.hpp"

namespace robot_vision
{

CompressedInfo readCompressedInfo(const unsigned char* data, std::size_t size)
{
  if (isJpeg(data, size)) return {"jpeg", readJpegInfo(data, size).size};
  if (!isPng(data, size)) throw std::invalid_argument(std::to_string(size) + " bytes are neither JPEG nor PNG");
  readPngInfo(data, size);
  const auto claimed = claimedSize(data, size);
  if (!claimed || claimed->width == 0 || claimed->height == 0)
    throw std::invalid_argument("PNG of " + std::to_string(size) + " bytes has no pixels");
  return {"png", cv::Size(static_cast<int>(claimed->width), static_cast<int>(claimed->height))};
}

}  // namespace robot_vision
