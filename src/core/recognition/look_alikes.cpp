#include "look_alikes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/core/affine.hpp>

namespace robot_vision
{
namespace
{

constexpr int kSide = 48;                                // px, of the images that are compared
constexpr double kDistance = 4.0;                        // of the viewer, in diameters
constexpr double kSameSurface = 0.02;                    // of the diameter
constexpr double kMinSurface = 0.97, kMaxColors = 0.97;  // share of the pixels that must be, and may be, the same
constexpr int kSameColor = 24;                           // difference of a channel

/// Views from directions that no axis of the mesh is alike to.
std::array<cv::Matx33d, 6> viewers()
{
  std::array<cv::Matx33d, 6> rotations;
  for (std::size_t i = 0; i < rotations.size(); ++i)
  {
    const double turn = 1.1 * static_cast<double>(i) + 0.4;
    rotations[i] = cv::Affine3d(cv::Vec3d(2.0 * std::sin(turn), 1.7 * std::cos(1.7 * turn), turn - 3.0)).rotation();
  }
  return rotations;
}

/// How many pixels two views have, and how many of them are alike in their surface, and in their colors as well.
struct Comparison
{
  int all = 0, surface = 0, colors = 0;

  void add(const MeshView& a, const MeshView& b, float gate)
  {
    for (int y = 0; y < a.depth.rows; ++y)
      for (int x = 0; x < a.depth.cols; ++x)
      {
        const float p = a.depth.at<float>(y, x), q = b.depth.at<float>(y, x);
        if (!(p > 0.0F) && !(q > 0.0F)) continue;
        ++all;
        if (!(std::abs(p - q) <= gate)) continue;
        ++surface;
        const auto &first = a.bgr.at<cv::Vec3b>(y, x), &second = b.bgr.at<cv::Vec3b>(y, x);
        bool is_alike = true;
        for (int i = 0; i < 3; ++i)
          is_alike &= std::abs(first[i] - second[i]) <= kSameColor;
        colors += is_alike ? 1 : 0;
      }
  }
};

/// Draws a mesh as it is seen from far away.
class Viewer
{
public:
  explicit Viewer(const MeshRenderer& renderer) : renderer_(renderer)
  {
    const MeshExtent& extent = renderer.extent();
    distance_ = kDistance * extent.diameter;
    const double middle = 0.5 * (kSide - 1), focus = 0.48 * kSide * distance_ / extent.radius;
    K_ = {focus, 0, middle, 0, focus, middle, 0, 0, 1};
  }

  void draw(const cv::Matx33d& rotation, MeshView& view) const
  {
    RenderParts parts;
    parts.bgr = true;
    const cv::Vec3d place = cv::Vec3d(0, 0, distance_) - rotation * renderer_.extent().center;
    renderer_.render(K_, {rotation, place}, {0, 0, kSide, kSide}, view, parts);
  }

private:
  const MeshRenderer& renderer_;
  double distance_;
  cv::Matx33d K_;
};

bool isLookAlike(const Viewer& viewer, const cv::Matx33d& turn, float gate)
{
  Comparison all;
  MeshView before, after;
  for (const cv::Matx33d& rotation : viewers())
  {
    viewer.draw(rotation, before);
    viewer.draw(rotation * turn, after);
    all.add(before, after, gate);
    if (all.surface < kMinSurface * all.all) return false;
  }
  return all.all > 0 && all.colors < kMaxColors * all.surface;
}

}  // namespace

std::vector<cv::Matx33d> findLookAlikes(const MeshRenderer& renderer)
{
  const Viewer viewer(renderer);
  const auto gate = static_cast<float>(kSameSurface * renderer.extent().diameter);
  std::vector<cv::Matx33d> turns;
  for (int axis = 0; axis < 3; ++axis)
    for (const double part : {1.0 / 2.0, 1.0 / 4.0, 3.0 / 4.0, 1.0 / 3.0, 2.0 / 3.0})
    {
      cv::Vec3d about;
      about[axis] = 2.0 * CV_PI * part;
      const cv::Matx33d turn = cv::Affine3d(about).rotation();
      if (isLookAlike(viewer, turn, gate)) turns.push_back(turn);
    }
  return turns;
}

}  // namespace robot_vision
