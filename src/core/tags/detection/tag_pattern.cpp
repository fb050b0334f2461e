#include "tag_pattern.hpp"

#include <cmath>

namespace robot_vision
{
namespace
{

constexpr int kWhite = -1;
constexpr int kBlack = -2;

/// Gray level between pixels; negative outside of the image.
double levelAt(const cv::Mat& gray, const cv::Point2d& position)
{
  const bool inside =
      position.x >= 0.0 && position.y >= 0.0 && position.x < gray.cols - 1 && position.y < gray.rows - 1;
  if (!inside) return -1.0;  // NaN is outside, too
  const auto x = static_cast<int>(position.x);
  const auto y = static_cast<int>(position.y);
  const double right = position.x - x;
  const double below = position.y - y;
  const auto* upper = gray.ptr<uchar>(y) + x;
  const auto* lower = gray.ptr<uchar>(y + 1) + x;
  return (1.0 - below) * (upper[0] + right * (upper[1] - upper[0])) +
         below * (lower[0] + right * (lower[1] - lower[0]));
}

}  // namespace

TagPattern::TagPattern(const apriltag_family_t& family) : quarter_(0.5 / family.width_at_border)
{
  const int side = family.width_at_border;
  const auto add = [this, side](int x, int y, int bit) {
    cells_.push_back({cv::Point2d(2 * x + 1 - side, 2 * y + 1 - side) / side, bit});
  };
  const auto addRing = [&add](int first, int last, int bit)
  {
    for (int i = first; i < last; ++i)
    {
      add(i, first, bit);
      add(last, i, bit);
      add(first + last - i, last, bit);
      add(first, first + last - i, bit);
    }
  };
  addRing(0, side - 1, family.reversed_border ? kWhite : kBlack);
  addRing(-1, side, family.reversed_border ? kBlack : kWhite);
  for (std::uint32_t i = 0; i < family.nbits; ++i)
    add(static_cast<int>(family.bit_x[i]), static_cast<int>(family.bit_y[i]), static_cast<int>(family.nbits - 1 - i));
}

double TagPattern::compare(const cv::Mat& gray, const cv::Matx33d& toPixels, std::uint64_t code) const
{
  double count = 0.0, sum = 0.0, squares = 0.0, white_count = 0.0, white_sum = 0.0;
  for (const Cell& cell : cells_)
  {
    const bool white = cell.bit == kWhite || (cell.bit >= 0 && (code >> cell.bit & 1) != 0);
    for (const double dy : {-quarter_, quarter_})
      for (const double dx : {-quarter_, quarter_})
      {
        const cv::Vec3d pixel = toPixels * cv::Vec3d(cell.middle.x + dx, cell.middle.y + dy, 1.0);
        const double level = levelAt(gray, {pixel[0] / pixel[2], pixel[1] / pixel[2]});
        if (level < 0.0) continue;
        count += 1.0;
        sum += level;
        squares += level * level;
        if (!white) continue;
        white_count += 1.0;
        white_sum += level;
      }
  }
  const double spread = (count * squares - sum * sum) * (count * white_count - white_count * white_count);
  return spread > 0.0 ? (count * white_sum - sum * white_count) / std::sqrt(spread) : 0.0;
}

}  // namespace robot_vision
