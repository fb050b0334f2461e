#include "color_gradients.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace robot_vision
{
namespace
{

/// The gradients of all channels of the pixels of a row but for the first and the last one, in loops over vectors.
struct ChannelGradients
{
  std::vector<std::int16_t> x, y, length;  // its length is the sum of the absolute values

  void find(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below, int pixels)
  {
    const std::size_t count = 3 * static_cast<std::size_t>(pixels);
    x.resize(count);
    y.resize(count);
    length.resize(count);
    std::int16_t *const along_x = x.data(), *const along_y = y.data(), *const lengths = length.data();
    for (std::size_t i = 3; i + 3 < count; ++i)
    {
      const int dx = above[i + 3] - above[i - 3] + 2 * (row[i + 3] - row[i - 3]) + below[i + 3] - below[i - 3];
      const int dy = below[i - 3] - above[i - 3] + 2 * (below[i] - above[i]) + below[i + 3] - above[i + 3];
      along_x[i] = static_cast<std::int16_t>(dx);
      along_y[i] = static_cast<std::int16_t>(dy);
      lengths[i] = static_cast<std::int16_t>(std::abs(dx) + std::abs(dy));
    }
  }

  /// Writes those of the channel that changes most.
  void takeSteepest(int pixels, std::int16_t* to) const
  {
    const std::int16_t *along_x = x.data(), *along_y = y.data(), *lengths = length.data();
    for (int i = 1; i + 1 < pixels; ++i)
    {
      const std::int16_t* const three = lengths + 3 * i;
      const int first = three[1] > three[0] ? 1 : 0, steepest = three[2] > three[first] ? 2 : first;
      to[2 * i] = along_x[3 * i + steepest];
      to[2 * i + 1] = along_y[3 * i + steepest];
    }
  }
};

}  // namespace

void colorGradients(const cv::Mat& bgr, cv::Mat& gradients)
{
  gradients.create(bgr.size(), CV_16SC2);
  ChannelGradients channels;
  for (int y = 0; y < bgr.rows; ++y)
  {
    auto* const to = gradients.ptr<std::int16_t>(y);
    const bool is_inside = y > 0 && y + 1 < bgr.rows && bgr.cols > 2;
    if (!is_inside)
    {
      std::fill(to, to + 2 * bgr.cols, std::int16_t{0});
      continue;
    }
    channels.find(bgr.ptr(y - 1), bgr.ptr(y), bgr.ptr(y + 1), bgr.cols);
    channels.takeSteepest(bgr.cols, to);
    to[0] = to[1] = to[2 * bgr.cols - 2] = to[2 * bgr.cols - 1] = 0;
  }
}

}  // namespace robot_vision
