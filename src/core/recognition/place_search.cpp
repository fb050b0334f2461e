#include "place_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd/kernel_tables.hpp"
#include "frame_kernels.hpp"

namespace robot_vision
{
namespace
{

// Distances (px) between places, of which each place has the largest one that its depth allows.
constexpr int kStrides[] = {1, 2, 3, 4, 6, 8, 12, 16, 24};
constexpr int kStrideCount = static_cast<int>(std::size(kStrides));
constexpr float kSameSurface = 0.02F;  // of inverse depths, as share
constexpr double kWindow = 0.8;        // side of the square that a cell looks at, in cells
constexpr double kBehind = 1.5;  // how far behind its anchor an object reaches, in halves of the width of all cells

constexpr double kDiagonal = 0.70710678118654752;
const cv::Vec2d kDirections[] = {{1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
                                 {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};

/// The mean inverse depth of a surface around a pixel.
float smoothed(const PaddedImage<float>& inverses, int x, int y)
{
  const float middle = inverses[y][x];
  float sum = 0.0F, count = 0.0F;
  for (int v = y - 1; v <= y + 1; ++v)
    for (int u = x - 1; u <= x + 1; ++u)
    {
      if (std::abs(inverses[v][u] - middle) > kSameSurface * middle) continue;
      sum += inverses[v][u];
      count += 1.0F;
    }
  return sum / count;
}

/// Farther surfaces beside what hides them, as far away as they are at a place if they go on as they do beside it.
class HiddenSurfaces
{
public:
  HiddenSurfaces(const ObservedFrame& frame, const ViewCamera& camera, double reach, float usual)
    : frame_(frame), camera_(camera), reach_(reach), usual_(usual)
  {
  }

  /// Calls visit(inverse depth) for up to two of them.
  template <class Visit>
  void at(int x, int y, const Visit& visit) const
  {
    const float seen = frame_.inverses()[y][x];
    const float inverse = seen > 0.0F ? seen : usual_;
    const float behind = seen > 0.0F ? 1.0F / (1.0F / seen + static_cast<float>(kLeastGap * reach_)) : 1e6F;
    float nearest = 0.0F, next = 0.0F;
    for (const double share : {0.35, 0.7})
      for (const cv::Vec2d& direction : kDirections)
      {
        const double radius = share * reach_ * camera_.focalLength() * inverse;
        const float found = beside(x, y, cvRound(x + radius * direction[0]), cvRound(y + radius * direction[1]));
        if (found >= behind || found <= 0.0F) continue;
        if (found > nearest)
        {
          if (nearest < found * kOther) next = nearest;
          nearest = found;
        }
        else if (found < nearest * kOther)
        {
          next = std::max(next, found);
        }
      }
    if (nearest > 0.0F) visit(nearest);
    if (next > 0.0F && next < nearest * kOther) visit(next);
  }

private:
  static constexpr double kLeastGap = 0.25;  // of the reach, between what hides and what is hidden
  static constexpr float kOther = 0.93F;     // of inverse depths of two surfaces that are not one

  float beside(int x, int y, int u, int v) const
  {
    const cv::Size& size = frame_.size();
    if (u < 0 || v < 0 || u >= size.width || v >= size.height) return 0.0F;
    const float inverse = frame_.inverses()[v][u];
    if (inverse == 0.0F || frame_.bins(0)[v][u] >> 16 == 0) return inverse;
    const auto dx = static_cast<float>((x - u) / camera_.fx()), dy = static_cast<float>((y - v) / camera_.fy());
    const float there = inverse + frame_.across()[v][u] * dx + frame_.along()[v][u] * dy;
    const float change = static_cast<float>(reach_) * inverse * inverse;
    return std::clamp(there, inverse - change, inverse + change);
  }

  const ObservedFrame& frame_;
  const ViewCamera& camera_;
  double reach_;
  float usual_;  // inverse depth of where there is none
};

/// Whether there are enough edges around a place for an object that reaches so far (m) to be there: of most of what is
/// seen there are none, as of a table with nothing on it.
bool mayBeObject(const ObservedFrame& frame, const ViewCamera& camera, const Place& place, double reach)
{
  constexpr double kAround = 0.8;  // of the reach, half the side of the square that is looked at
  constexpr double kEdges = 1.2;   // least length of edges, of the reach
  const double pixels = reach * camera.focalLength() * place.inverse;
  const int around = cvRound(kAround * pixels);
  return frame.edges(place.x - around, place.y - around, place.x + around + 1, place.y + around + 1) >= kEdges * pixels;
}

bool isWanted(const cv::Mat& mask, int x, int y)
{
  return mask.empty() || mask.at<std::uint8_t>(y, x) != 0;
}

std::uint32_t inverseCode(double inverse)
{
  return static_cast<std::uint32_t>(std::clamp(inverse * ObservedFrame::kInverseSteps, 1.0, 65534.0));
}

/// Where the cells around a place are, and which depths belong to an object there.
struct CellGrid
{
  CellGrid(const ViewCamera& camera, const Place& place, double half_width)
  {
    const double rx = (place.x - camera.cx()) / camera.fx(), ry = (place.y - camera.cy()) / camera.fy();
    const cv::Matx33d ray = rayFrame(rx, ry);
    const double cell = 2.0 * half_width / kCells;
    // The derivative of the pixel's position by x and y in the ray's frame.
    const cv::Vec2d ux(camera.fx() * (ray(0, 0) - rx * ray(2, 0)), camera.fy() * (ray(1, 0) - ry * ray(2, 0)));
    const cv::Vec2d uy(camera.fx() * (ray(0, 1) - rx * ray(2, 1)), camera.fy() * (ray(1, 1) - ry * ray(2, 1)));
    across = ux * (cell * place.inverse);
    along = uy * (cell * place.inverse);
    window = windowAt(place.inverse, camera, half_width, kWindow);
    const double half = 0.5 * (kWindows[window] - 1);
    first = cv::Vec2d(place.x - half, place.y - half) - (0.5 * (kCells - 1)) * (across + along);
    const double z = 1.0 / place.inverse;
    least = inverseCode(1.0 / (z + kBehind * half_width));
    most = inverseCode(1.0 / std::max(z - half_width, 0.01));
  }

  cv::Vec2d first, across, along;  // px, the corner of the first window, and from one to the next
  std::size_t window = 0;
  std::uint32_t least = 0, most = 0;
};

}  // namespace

cv::Matx33d rayFrame(double x, double y)
{
  const double length = 1.0 / std::sqrt(x * x + y * y + 1.0);
  const double u = x * length, v = y * length, share = 1.0 / (1.0 + length);
  return {1.0 - u * u * share, -u * v * share, u, -u * v * share, 1.0 - v * v * share, v, -u, -v, length};
}

std::size_t windowAt(float inverse, const ViewCamera& camera, double half_width, double cells)
{
  const double side = cells * 2.0 * half_width / kCells * camera.focalLength() * inverse;
  std::size_t best = 0;
  for (std::size_t i = 1; i < kWindows.size(); ++i)
    if (std::abs(kWindows[i] - side) < std::abs(kWindows[best] - side)) best = i;
  return best;
}

std::vector<Place> findPlaces(const ObservedFrame& frame, const ViewCamera& camera, double step, double reach,
                              float min_inverse, float max_inverse, const cv::Mat& mask)
{
  const PaddedImage<float>& inverses = frame.inverses();
  const double pixels = step * camera.focalLength();  // from a place to the next at 1 m
  // Where there is no depth the object is as far away as it usually is, within the limits.
  const float usual = std::max(min_inverse, std::min(1.0F, std::nextafter(max_inverse, 0.0F)));
  const HiddenSurfaces hidden(frame, camera, reach, usual);
  std::vector<Place> places;
  const auto add = [&](const Place& place)
  {
    if (mayBeObject(frame, camera, place, reach)) places.push_back(place);
  };
  for (int i = 0; i < kStrideCount; ++i)
  {
    const int stride = kStrides[i];
    const float least = i == 0 ? 0.0F : static_cast<float>(stride / pixels);
    const float most = i + 1 == kStrideCount ? 1e6F : static_cast<float>(kStrides[i + 1] / pixels);
    const float low = std::max(least, min_inverse), high = std::min(most, max_inverse);
    if (low >= high) continue;
    for (int y = stride / 2; y < frame.size().height; y += stride)
    {
      const float* const row = inverses[y];
      for (int x = stride / 2; x < frame.size().width; x += stride)
      {
        if (!isWanted(mask, x, y)) continue;
        const bool unknown = row[x] == 0.0F && usual >= low && usual < high;
        if (!unknown && (row[x] < low || row[x] >= high)) continue;
        if (!unknown) add({x, y, smoothed(inverses, x, y)});
        hidden.at(x, y,
                  [&](float inverse)
                  {
                    if (inverse >= min_inverse && inverse < max_inverse) add({x, y, inverse});
                  });
      }
    }
  }
  return places;
}

std::vector<Place> placesAt(float inverse, const ObservedFrame& frame, const ViewCamera& camera, double step,
                            double reach, const cv::Mat& mask)
{
  const int stride = std::max(1, static_cast<int>(step * camera.focalLength() * inverse));
  std::vector<Place> places;
  for (int y = stride / 2; y < camera.size().height; y += stride)
    for (int x = stride / 2; x < camera.size().width; x += stride)
      if (isWanted(mask, x, y) && mayBeObject(frame, camera, {x, y, inverse}, reach)) places.push_back({x, y, inverse});
  return places;
}

void PlacePlanes::prepare(const ObservedFrame& frame, const ViewCamera& camera, const Place* places, int count,
                          double half_width)
{
  for (int i = 0; i < kPlacesAtOnce; ++i)
  {
    const CellGrid grid(camera, places[std::min(i, count - 1)], half_width);
    lanes_.x[i] = static_cast<float>(grid.first[0]);
    lanes_.y[i] = static_cast<float>(grid.first[1]);
    lanes_.across_x[i] = static_cast<float>(grid.across[0]);
    lanes_.across_y[i] = static_cast<float>(grid.across[1]);
    lanes_.along_x[i] = static_cast<float>(grid.along[0]);
    lanes_.along_y[i] = static_cast<float>(grid.along[1]);
    lanes_.window[i] = static_cast<int>(grid.window) * frame.nextWindow();
    lanes_.least[i] = grid.least;
    lanes_.most[i] = grid.most;
  }
  const SearchedFrame searched{frame.bins(0)[0],
                               frame.hasDepth() ? frame.ranges(0)[0] : nullptr,
                               frame.bins(0).stride,
                               PaddedImage<std::uint32_t>::kPad,
                               static_cast<float>(frame.size().width),
                               static_cast<float>(frame.size().height)};
  planes_.resize(static_cast<std::size_t>(kCells * kCells * kCellBins * kPlacesAtOnce));
  const SearchKernels& loops = kernels<SearchKernels>();
  std::uint8_t* planes = planes_.data();
  for (int row = 0; row < kCells; ++row)
    for (int column = 0; column < kCells; ++column, planes += kCellBins * kPlacesAtOnce)
      loops.gather(searched, lanes_, column, row, planes);
}

}  // namespace robot_vision
