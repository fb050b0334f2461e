#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace robot_vision
{

/// Equals cv::CLAHE (contrast limited adaptive histogram equalization) for CV_8UC1 and CV_16UC1, to the bit. 8 bits
/// take as many threads as cv::setNumThreads() allows; 16 bits are OpenCV's, and so are all where OpenCV itself rounds
/// otherwise than in its order of sums.
class TileEqualizer
{
public:
  /// `limit` is that of the contrast, above 0; there are `tiles` x `tiles` tiles.
  TileEqualizer(double limit, int tiles);

  /// `out` is reused if it fits, and must not be `gray`.
  void apply(const cv::Mat& gray, cv::Mat& out);

private:
  using Table = std::array<std::uint8_t, 256>;

  /// Of pixels along one side of an image: the tiles before and behind them, and their shares.
  struct Places
  {
    Places(int pixels, int tile_size, int tiles);

    std::vector<int> before;
    std::vector<int> behind;
    std::vector<float> share_before;
    std::vector<float> share_behind;
  };

  void equalize(const cv::Mat& gray, cv::Mat& out);
  Table tableOf(const cv::Mat& tile) const;
  void interpolateRows(const cv::Mat& gray, const std::vector<Table>& tables, const Places& x, const Places& y,
                       const cv::Range& rows, cv::Mat& out) const;

  static bool isExact();

  double limit_;
  int tiles_;
  cv::Ptr<cv::CLAHE> opencv_;
};

}  // namespace robot_vision
