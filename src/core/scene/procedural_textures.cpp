// The surfaces of the room. None of them is blue or rich in contrast, so that colour filters and marker detectors find
// only the objects they are meant to find.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "scene_random.hpp"
#include "scene_textures.hpp"

namespace robot_vision::scene
{

namespace
{

const double kTexel = 0.005;  // m, on walls and floor

// A number in [0, 1) for two integers. It does not depend on SceneParams::seed, so the surfaces are always the same.
double hashed(int a, int b)
{
  const auto low = static_cast<std::uint32_t>(a), high = static_cast<std::uint32_t>(b);
  return unitInterval(mix((static_cast<std::uint64_t>(high) << 32) | low));
}

// Smooth value noise on a grid of unit cells, from -1 to 1.
double smoothNoise(double x, double y)
{
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const auto ease = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double fx = ease(x - ix), fy = ease(y - iy);
  const double top = hashed(ix, iy) * (1.0 - fx) + hashed(ix + 1, iy) * fx;
  const double bottom = hashed(ix, iy + 1) * (1.0 - fx) + hashed(ix + 1, iy + 1) * fx;
  return 2.0 * (top * (1.0 - fy) + bottom * fy) - 1.0;
}

cv::Vec3b scaled(const cv::Vec3d& bgr, double factor)
{
  cv::Vec3b colour;
  for (int i = 0; i < 3; ++i)
    colour[i] = cv::saturate_cast<uchar>(bgr[i] * factor);
  return colour;
}

cv::Mat blank(const cv::Size2d& metres)
{
  return cv::Mat(cvCeil(metres.height / kTexel), cvCeil(metres.width / kTexel), CV_8UC3);
}

// Distance to the nearest joint in a row of bricks or planks of the given length.
double distanceToJoint(double position, double length)
{
  const double phase = position / length - std::floor(position / length);
  return length * std::min(phase, 1.0 - phase);
}

}  // namespace

cv::Mat wallImage(const cv::Size2d& metres, double shade)
{
  const cv::Vec3d paint(150, 174, 184);
  const double brick_width = 0.26, brick_height = 0.09, joint = 0.006;
  cv::Mat wall = blank(metres);
  wall.forEach<cv::Vec3b>(
      [&](cv::Vec3b& pixel, const int* at)
      {
        const double y = at[0] * kTexel;
        const int course = static_cast<int>(y / brick_height);
        const double x = at[1] * kTexel + (course % 2) * brick_width / 2.0;
        const double light = 1.06 - 0.16 * y / metres.height;
        const bool mortar = std::min(distanceToJoint(x, brick_width), distanceToJoint(y, brick_height)) < joint;
        const double brick = 0.03 * (hashed(static_cast<int>(x / brick_width), course) - 0.5);
        const double blotch = 0.02 * smoothNoise(x / 0.4, y / 0.4) + 0.008 * smoothNoise(x / 0.02, y / 0.02);
        pixel = scaled(paint, shade * light * (mortar ? 0.955 : 1.0 + brick) * (1.0 + blotch));
      });
  return wall;
}

cv::Mat floorImage(const cv::Size2d& metres)
{
  const cv::Vec3d wood(150, 186, 206);
  const double plank_width = 0.18, plank_length = 1.1, joint = 0.004;
  cv::Mat floor = blank(metres);
  floor.forEach<cv::Vec3b>(
      [&](cv::Vec3b& pixel, const int* at)
      {
        const double x = at[1] * kTexel;
        const int plank = static_cast<int>(x / plank_width);
        const double y = at[0] * kTexel + plank_length * hashed(plank, 7);
        const int piece = static_cast<int>(y / plank_length);
        const bool gap = std::min(distanceToJoint(x, plank_width), distanceToJoint(y, plank_length)) < joint;
        const double tone = 0.07 * (hashed(plank, piece + 100) - 0.5);
        const double grain = 0.025 * smoothNoise(x / 0.012, y / 0.35 + 17.0 * plank);
        pixel = scaled(wood, gap ? 0.88 : 1.0 + tone + grain);
      });
  return floor;
}

cv::Mat tableImage(const cv::Size2d& metres)
{
  const cv::Vec3d wood(84, 118, 146);
  const double board = 0.12;  // m
  cv::Mat table = blank(metres);
  table.forEach<cv::Vec3b>(
      [&](cv::Vec3b& pixel, const int* at)
      {
        const double x = at[1] * kTexel, y = at[0] * kTexel;
        const int piece = static_cast<int>(y / board);
        const double tone = 0.08 * (hashed(piece, 31) - 0.5);
        const double grain =
            0.04 * smoothNoise(x / 0.3 + 11.0 * piece, y / 0.008) + 0.02 * smoothNoise(x / 0.1, y / 0.1);
        pixel = scaled(wood, 1.0 + tone + grain);
      });
  return table;
}

cv::Mat crateImage(double shade)
{
  const cv::Vec3d paint(58, 84, 214), slat(70, 104, 232);
  const int size = 256, rim = 30, plank = 49;
  cv::Mat crate(size, size, CV_8UC3);
  crate.forEach<cv::Vec3b>(
      [&](cv::Vec3b& pixel, const int* at)
      {
        const int x = at[1], y = at[0];
        const int edge = std::min(std::min(x, y), std::min(size - 1 - x, size - 1 - y));
        const bool gap = edge >= rim && (y - rim) % plank < 3;
        const bool groove = edge >= rim - 3 && edge < rim;
        const double grain = 0.05 * smoothNoise(x / 60.0, y / 4.0);
        pixel = scaled(edge < rim ? slat : paint, shade * (gap || groove ? 0.6 : 1.0 + grain));
      });
  return crate;
}

cv::Mat posterPattern()
{
  const std::array<cv::Scalar, 6> palette = {cv::Scalar(48, 62, 208),  cv::Scalar(52, 178, 240),
                                             cv::Scalar(96, 156, 62),  cv::Scalar(206, 228, 240),
                                             cv::Scalar(132, 92, 196), cv::Scalar(48, 44, 62)};
  const int tile = 256, columns = 4, rows = 4, fraction_bits = 4;
  cv::Mat poster(rows * tile, columns * tile, CV_8UC3);
  for (int row = 0; row < rows; ++row)
  {
    for (int column = 0; column < columns; ++column)
    {
      const auto pick = [&](int layer) { return static_cast<int>(hashed(row * columns + column, layer) * 6.0); };
      const int back = pick(1), front = (back + 1 + pick(2) % 5) % 6, inner = (front + 1 + pick(3) % 5) % 6;
      cv::Mat cell = poster(cv::Rect(column * tile, row * tile, tile, tile));
      cell.setTo(palette[back]);
      const cv::Point corner((row + column) % 2 == 0 ? 0 : tile, pick(4) % 2 == 0 ? 0 : tile);
      const cv::Point center = corner * (1 << fraction_bits);
      cv::circle(cell, center, tile << fraction_bits, palette[front], cv::FILLED, cv::LINE_AA, fraction_bits);
      cv::circle(cell, center, (tile / 2) << fraction_bits, palette[inner], cv::FILLED, cv::LINE_AA, fraction_bits);
    }
  }
  return poster;
}

cv::Mat plainImage(const cv::Size2d& metres, double texel, const cv::Scalar& bgr)
{
  return cv::Mat(cvCeil(metres.height / texel), cvCeil(metres.width / texel), CV_8UC3, bgr);
}

void castShadow(cv::Mat& bgr, const std::vector<cv::Point2d>& polygon, double strength, double blur)
{
  std::vector<cv::Point> points;
  for (const cv::Point2d& p : polygon)
    points.emplace_back(cvRound(p.x), cvRound(p.y));
  cv::Mat mask(bgr.size(), CV_32FC1, cv::Scalar(0));
  cv::fillConvexPoly(mask, points, cv::Scalar(1));
  cv::GaussianBlur(mask, mask, cv::Size(), blur);
  bgr.forEach<cv::Vec3b>([&](cv::Vec3b& pixel, const int* at)
                         { pixel = scaled(cv::Vec3d(pixel), 1.0 - strength * mask.at<float>(at)); });
}

cv::Mat shadowDisc(double strength)
{
  const int size = 64;
  cv::Mat disc(size, size, CV_8UC4);
  disc.forEach<cv::Vec4b>(
      [&](cv::Vec4b& pixel, const int* at)
      {
        const double distance = std::hypot(2.0 * (at[1] + 0.5) / size - 1.0, 2.0 * (at[0] + 0.5) / size - 1.0);
        const double t = std::clamp(1.0 - distance, 0.0, 1.0);
        pixel = cv::Vec4b(18, 22, 26, cv::saturate_cast<uchar>(strength * t * t * (3 - 2 * t)));
      });
  return disc;
}

}  // namespace robot_vision::scene
