#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision
{

/// A texture in several resolutions, each half as large as the one before. It repeats beyond its borders.
class MeshTexture
{
public:
  /// `image` is CV_8UC3.
  explicit MeshTexture(const cv::Mat& image);

  cv::Size size() const { return levels_.front().size(); }

  /// The color at (u, v), in units of the texture's size, where the texels of the finest level that neighbouring pixels
  /// see are so far apart, squared: between the four nearest texels of the level on which that is about one.
  cv::Vec3f color(float u, float v, float squared_texels) const;

private:
  std::vector<cv::Mat> levels_;
};

}  // namespace robot_vision
