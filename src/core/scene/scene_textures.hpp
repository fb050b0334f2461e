#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision::scene
{

/// One resolution of a texture. A texel has four bytes: B, G, R and alpha, from the lowest bits. The content has a
/// border one texel wide that repeats its colours but is transparent: sampling across the edge gives an anti-aliased
/// outline, centred exactly on the edge.
struct TextureLevel
{
  int width = 0;  // texels, without the border
  int height = 0;
  std::vector<std::uint32_t> texels;  // (width + 2) x (height + 2)
};

/// An image in several resolutions, the finest first. A level is made when it is first drawn, because most never are.
class Texture
{
public:
  Texture() = default;

  /// `image` is CV_8UC3 or (with alpha) CV_8UC4, and kept without a copy; `interpolation` is one of
  /// cv::InterpolationFlags.
  Texture(const cv::Mat& image, const std::vector<cv::Size>& sizes, int interpolation);

  /// The sizes of the levels in texels.
  const std::vector<cv::Size>& sizes() const { return sizes_; }

  /// Thread-safe.
  const TextureLevel& level(std::size_t index) const;

private:
  struct Slot
  {
    std::once_flag once;
    TextureLevel level;
  };

  cv::Mat image_;
  std::vector<cv::Size> sizes_;
  int interpolation_ = 0;
  std::shared_ptr<Slot[]> slots_;  // shared by all copies of the texture
};

/// A texture of square cells of one colour each, given as an image of one pixel per cell (CV_8UC3). In every level a
/// cell is a whole number of texels wide, so that the borders between cells stay exactly where they belong.
Texture cellTexture(const cv::Mat& cells_bgr);

/// A texture of an image, CV_8UC3 or (with alpha) CV_8UC4, which is kept without a copy. Each level has half as many
/// texels as the one before.
Texture imageTexture(const cv::Mat& image);

/// Cells of an AprilTag of family tag36h11 (id 0 or 1) with the white border, 10 x 10, CV_8UC3.
cv::Mat tagCells(int id);

/// Modules of the QR code "robot_vision" (version 1, level M) with a quiet zone of 3 modules, 27 x 27, CV_8UC3.
cv::Mat qrCells();

/// Half squares of a board with 8 x 6 inner corners and a white margin of half a square, 20 x 16, CV_8UC3.
cv::Mat checkerCells();

/// The image that hangs on the wall if the user gives none.
cv::Mat posterPattern();

/// A painted brick wall of low contrast, lit from above. `shade` scales the brightness.
cv::Mat wallImage(const cv::Size2d& metres, double shade);

/// A floor of light planks that run away from the camera.
cv::Mat floorImage(const cv::Size2d& metres);

/// The top of a table, of dark wood.
cv::Mat tableImage(const cv::Size2d& metres);

/// One side of a wooden crate. `shade` scales the brightness.
cv::Mat crateImage(double shade);

/// An area of one colour. `texel` (m) limits how sharp its outline can be.
cv::Mat plainImage(const cv::Size2d& metres, double texel, const cv::Scalar& bgr);

/// Darkens an image by up to `strength` (0 to 1) inside a polygon given in its pixels. `blur` is the standard deviation
/// of the soft edge in pixels.
void castShadow(cv::Mat& bgr, const std::vector<cv::Point2d>& polygon, double strength, double blur);

/// A soft black disc (CV_8UC4), its alpha falling from `strength` (0 to 255) in the middle to nothing at the edge.
cv::Mat shadowDisc(double strength);

}  // namespace robot_vision::scene
