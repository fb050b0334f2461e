#include "scene_textures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/image/rects.hpp"

namespace robot_vision::scene
{

namespace
{

std::uint32_t pack(const cv::Vec4b& colour)
{
  std::uint32_t texel = 0;
  for (int channel = 0; channel < 4; ++channel)
    texel |= static_cast<std::uint32_t>(colour[channel]) << (8 * channel);
  return texel;
}

cv::Mat withAlpha(const cv::Mat& image)
{
  if (image.type() == CV_8UC4) return image;
  cv::Mat bgra;
  cv::cvtColor(image, bgra, cv::COLOR_BGR2BGRA);
  return bgra;
}

TextureLevel makeLevel(const cv::Mat& bgra)
{
  TextureLevel level;
  level.width = bgra.cols;
  level.height = bgra.rows;
  level.texels.reserve(static_cast<std::size_t>(bgra.cols + 2) * (bgra.rows + 2));
  for (int y = -1; y <= bgra.rows; ++y)
  {
    for (int x = -1; x <= bgra.cols; ++x)
    {
      const int inside_x = std::clamp(x, 0, bgra.cols - 1), inside_y = std::clamp(y, 0, bgra.rows - 1);
      cv::Vec4b colour = bgra.at<cv::Vec4b>(inside_y, inside_x);
      if (x != inside_x || y != inside_y) colour[3] = 0;
      level.texels.push_back(pack(colour));
    }
  }
  return level;
}

}  // namespace

Texture::Texture(const cv::Mat& image, const std::vector<cv::Size>& sizes, int interpolation)
  : image_(image), sizes_(sizes), interpolation_(interpolation), slots_(new Slot[sizes.size()])
{
}

const TextureLevel& Texture::level(std::size_t index) const
{
  Slot& slot = slots_[index];
  std::call_once(slot.once,
                 [&]
                 {
                   cv::Mat scaled;
                   cv::resize(image_, scaled, sizes_[index], 0, 0, interpolation_);
                   slot.level = makeLevel(withAlpha(scaled));
                 });
  return slot.level;
}

Texture cellTexture(const cv::Mat& cells_bgr)
{
  // The levels come in small steps, so that a texel is never much larger than a pixel.
  const int max_texels = 512;  // along the longer side; limits the memory
  const int cells = std::max(cells_bgr.cols, cells_bgr.rows);
  std::vector<cv::Size> sizes;
  for (const int texels_per_cell : {32, 28, 24, 20, 16, 14, 12, 10, 8, 7, 6, 5, 4, 3, 2, 1})
    if (texels_per_cell * cells <= max_texels) sizes.push_back(cells_bgr.size() * texels_per_cell);
  return Texture(cells_bgr, sizes, cv::INTER_NEAREST);
}

Texture imageTexture(const cv::Mat& image)
{
  std::vector<cv::Size> sizes;
  for (double scale = 1.0; sizes.empty() || std::max(sizes.back().width, sizes.back().height) > 4;
       scale /= std::sqrt(2.0))
    sizes.push_back(scaledSize(image.size(), scale));
  return Texture(image, sizes, cv::INTER_AREA);
}

}  // namespace robot_vision::scene
