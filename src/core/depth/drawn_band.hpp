#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "cell_kernels.hpp"

namespace robot_vision
{

/// A projected pixel of a depth image, see VertexRow.
struct Vertex
{
  std::int32_t u, v;
  float w;
};

/// How far it is in the other image from a pixel of the depth image half the way to its right and its lower neighbour,
/// in steps, if what they see is about as far from both cameras.
struct HalfCell
{
  cv::Point right;
  cv::Point down;
};

/// The rows of the other camera's image that one thread draws: at each pixel the inverse of the nearest depth.
///
/// A pixel is drawn whose centre is in a triangle, or on its border; positions are whole steps, so that this is exact,
/// and neighbours leave no gap. Inverse depths are linear in the image of a plane. Triangles seen from behind are not
/// drawn: what they belong to would hide them. Where a cell has no triangle, as something else begins there, the
/// quarter of the cell beside each of its pixels is as far as that pixel.
class DrawnBand
{
public:
  /// Begins anew, for images of this width. The depths of one surface at the corners of a cell differ by the factor
  /// `max_ratio` at most.
  void reset(int width, const cv::Range& rows, float max_ratio, const HalfCell& half);

  /// Draws the cells between two rows of vertices.
  void draw(const VertexRow& upper, const VertexRow& lower, int cells);

  /// Inverse depths (1/m, 0: none) of a row of the image.
  const float* row(int y) const { return pixels_.ptr<float>(y - rows_.begin + rows_.margin) + rows_.margin; }

private:
  /// Clockwise from the top left.
  using Cell = std::array<Vertex, 4>;

  template <int kSide>
  void draw(const VertexRow& upper, const VertexRow& lower, int cells);
  template <int kSide>
  void add(int offset, const float* values);
  int sideOf(const VertexRow& upper, const VertexRow& lower, int cells) const;
  bool isSurface(const Vertex& a, const Vertex& b, const Vertex& c) const;
  void drawCell(const Cell& cell);
  void drawQuarter(const Vertex& vertex, int corner);
  void drawTriangle(const Vertex& a, const Vertex& b, const Vertex& c);

  DrawnRows rows_{};
  HalfCell half_;
  cv::Mat pixels_;  // CV_32FC1, the rows and a margin around them
};

}  // namespace robot_vision
