#include "mesh_shades.hpp"

namespace robot_vision
{
namespace
{

std::size_t at(int index)
{
  return static_cast<std::size_t>(index);
}

/// The weights of the three corners of a triangle, divided by w, as functions of the ray.
class Weights
{
public:
  Weights(const SeenVertex* vertices, const cv::Vec3i& corners)
  {
    const SeenVertex &a = vertices[corners[0]], &b = vertices[corners[1]], &c = vertices[corners[2]];
    const cv::Vec3d bc = cross(b, c);
    const double inverse = 1.0 / (a.x * bc[0] + a.y * bc[1] + a.w * bc[2]);
    corners_[0] = bc * inverse;
    corners_[1] = cross(c, a) * inverse;
    corners_[2] = cross(a, b) * inverse;
  }

  /// The function of a number that the corners have.
  RayFunction of(float a, float b, float c) const
  {
    return {a * corners_[0][0] + b * corners_[1][0] + c * corners_[2][0],
            a * corners_[0][1] + b * corners_[1][1] + c * corners_[2][1],
            a * corners_[0][2] + b * corners_[1][2] + c * corners_[2][2]};
  }

private:
  static cv::Vec3d cross(const SeenVertex& a, const SeenVertex& b)
  {
    return {a.y * b.w - a.w * b.y, a.w * b.x - a.x * b.w, a.x * b.y - a.y * b.x};
  }

  cv::Vec3f corners_[3];
};

}  // namespace

TextureShade textureShade(const MeshLook& look, const SeenVertex* vertices, int triangle)
{
  const int texture = look.triangle_textures[at(triangle)];
  if (texture < 0) return {};
  const cv::Vec3i& corners = look.triangles[at(triangle)];
  const Weights weights(vertices, corners);
  const cv::Vec2f &a = look.texture_coordinates[at(corners[0])], &b = look.texture_coordinates[at(corners[1])],
                  &c = look.texture_coordinates[at(corners[2])];
  return {&look.textures[at(texture)], weights.of(1.0F, 1.0F, 1.0F), weights.of(a[0], b[0], c[0]),
          weights.of(a[1], b[1], c[1])};
}

}  // namespace robot_vision
