#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <vector>

namespace robot_vision::scene
{

/// One resolution of a texture. A texel is four 16-bit lanes (B, G, R, alpha, from the lowest) holding 0 to 255, so one
/// 64-bit multiplication scales all of them. Around the content lies a border, one texel wide, of the same colours but
/// transparent: sampling across the edge gives an anti-aliased outline, centred exactly on the edge.
struct TextureLevel
{
  int width = 0;  // texels, without the border
  int height = 0;
  std::vector<std::uint64_t> texels;  // (width + 2) x (height + 2)
};

/// A picture in some resolutions, the finest first. Each is made when it is first drawn, as most never are.
class Texture
{
public:
  Texture() = default;

  /// `picture` is CV_8UC3 or (with alpha) CV_8UC4, `interpolation` one of cv::InterpolationFlags.
  Texture(const cv::Mat& picture, const std::vector<cv::Size>& sizes, int interpolation);

  /// Of the levels, in texels.
  const std::vector<cv::Size>& sizes() const { return sizes_; }

  /// Thread-safe.
  const TextureLevel& level(std::size_t index) const;

private:
  struct Slot
  {
    std::once_flag once;
    TextureLevel level;
  };

  cv::Mat picture_;
  std::vector<cv::Size> sizes_;
  int interpolation_ = 0;
  std::shared_ptr<Slot[]> slots_;  // of all copies
};

/// A texture of flat square cells (CV_8UC3): in every level a cell is a whole number of texels, so that all borders
/// between cells stay exactly where they belong.
Texture cellTexture(const cv::Mat& cells_bgr);

/// A texture of a picture, CV_8UC3 or (with alpha, CV_8UC4), with half the texels from level to level.
Texture pictureTexture(const cv::Mat& picture);

/// Cells of an AprilTag of family tag36h11 (id 0 or 1) with the white border, 10 x 10, CV_8UC3.
cv::Mat tagCells(int id);

/// Modules of the QR code "robot_vision" (version 1, level M) with a quiet zone of 3 modules, 27 x 27, CV_8UC3.
cv::Mat qrCells();

/// Half squares of a board with 8 x 6 inner corners and a white margin of half a square, 20 x 16, CV_8UC3.
cv::Mat checkerCells();

/// The picture that hangs on the wall when the user gives none.
cv::Mat posterPattern();

/// A painted wall of the given size: bricks of low contrast, lit from above. `shade` scales the brightness.
cv::Mat wallPicture(const cv::Size2d& metres, double shade);

/// Light planks running away from the camera.
cv::Mat floorPicture(const cv::Size2d& metres);

/// A wooden crate's side.
cv::Mat cratePicture(double shade);

/// A flat colour; `texel` in metres is as sharp as its outline can be.
cv::Mat plainPicture(const cv::Size2d& metres, double texel, const cv::Scalar& bgr);

/// Darkens a picture, by up to `strength` (0 to 1), under a polygon given in its pixels; `blur` is the standard
/// deviation of the soft edge in pixels.
void castShadow(cv::Mat& bgr, const std::vector<cv::Point2d>& polygon, double strength, double blur);

/// A soft black disc (CV_8UC4), its alpha falling from `strength` (0 to 255) in the middle to nothing at the edge.
cv::Mat shadowDisc(double strength);

}  // namespace robot_vision::scene
