// The samples with flat faces.

#include <opencv2/imgproc.hpp>

#include "mesh_builder.hpp"
#include "sample_meshes.hpp"

namespace robot_vision::samples
{
namespace
{

constexpr int kPixelsPerMetre = 2400;
const cv::Vec3d kBoxSize(0.11, 0.055, 0.16);  // m

cv::Size facePixels(double width, double height)
{
  return {cvRound(width * kPixelsPerMetre), cvRound(height * kPixelsPerMetre)};
}

/// What is printed on a large side: a band, a sun or a leaf, and words.
cv::Mat printedSide(const cv::Size& size, bool front)
{
  cv::Mat image(size, CV_8UC3, cv::Scalar(60, 190, 235));
  const int w = size.width, h = size.height;
  const cv::Scalar dark(70, 40, 30), bright(240, 245, 245);
  cv::rectangle(image, {0, h / 10, w, h / 5}, front ? cv::Scalar(40, 40, 200) : cv::Scalar(120, 90, 20), cv::FILLED);
  cv::putText(image, front ? "CRUNCH" : "EAT ME", {w / 12, h / 10 + h / 7}, cv::FONT_HERSHEY_DUPLEX, w / 160.0, bright,
              w / 60, cv::LINE_AA);
  if (front)
  {
    cv::circle(image, {w * 3 / 5, h * 3 / 5}, w / 4, {30, 120, 240}, cv::FILLED, cv::LINE_AA);
    cv::ellipse(image, {w * 3 / 5, h * 3 / 5}, {w / 3, w / 10}, 30.0, 0.0, 360.0, bright, w / 40, cv::LINE_AA);
  }
  else
  {
    for (int line = 0; line < 7; ++line)
      cv::line(image, {w / 10, h * (8 + line) / 20}, {w * (5 + (line * 5) % 4) / 10, h * (8 + line) / 20}, dark, w / 50,
               cv::LINE_AA);
    cv::ellipse(image, {w * 4 / 5, h * 3 / 5}, {w / 9, w / 6}, -30.0, 0.0, 360.0, {60, 130, 40}, cv::FILLED,
                cv::LINE_AA);
  }
  for (int i = 0; i < 9; ++i)  // a code of bars
    cv::rectangle(image, {w / 10 + i * w / 30, h * 17 / 20, w / (i % 3 == 0 ? 45 : 90), h / 12}, dark, cv::FILLED);
  return image;
}

/// The other sides have stripes of their own.
cv::Mat stripedSide(const cv::Size& size, const cv::Scalar& color, int stripes)
{
  cv::Mat image(size, CV_8UC3, cv::Scalar(60, 190, 235));
  for (int i = 0; i < stripes; ++i)
    cv::rectangle(image,
                  {0, size.height * (2 * i + 1) / (2 * stripes + 1), size.width, size.height / (2 * stripes + 1)},
                  color, cv::FILLED);
  cv::circle(image, {size.width * 2 / 3, size.height / 3}, size.width / 6, {240, 245, 245}, cv::FILLED, cv::LINE_AA);
  return image;
}

/// Adds a side with its own texture: `corner` is its bottom left one for who looks at it.
void addSide(Mesh& mesh, const cv::Vec3d& corner, const cv::Vec3d& right, const cv::Vec3d& up, const cv::Mat& texture)
{
  const auto first = static_cast<int>(mesh.vertices.size());
  for (const cv::Vec2f& uv : {cv::Vec2f(0, 1), cv::Vec2f(1, 1), cv::Vec2f(1, 0), cv::Vec2f(0, 0)})
  {
    mesh.vertices.emplace_back(corner + right * uv[0] + up * (1.0 - uv[1]));
    mesh.normals.emplace_back(cv::normalize(right.cross(up)));
    mesh.texture_coordinates.push_back(uv);
  }
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
  mesh.triangle_textures.insert(mesh.triangle_textures.end(), 2, static_cast<int>(mesh.textures.size()));
  mesh.textures.push_back(texture);
}

}  // namespace

Mesh box()
{
  const double x = kBoxSize[0], y = kBoxSize[1], z = kBoxSize[2];
  const cv::Vec3d right(x, 0, 0), back(0, y, 0), up(0, 0, z), low(-x / 2, -y / 2, 0);
  Mesh mesh;
  addSide(mesh, low, right, up, printedSide(facePixels(x, z), true));
  addSide(mesh, low + right + back, -right, up, printedSide(facePixels(x, z), false));
  addSide(mesh, low + right, back, up, stripedSide(facePixels(y, z), {40, 40, 200}, 3));
  addSide(mesh, low + back, -back, up, stripedSide(facePixels(y, z), {120, 90, 20}, 5));
  addSide(mesh, low + up, right, back, stripedSide(facePixels(x, y), {40, 110, 60}, 2));
  addSide(mesh, low + back, right, -back, stripedSide(facePixels(x, y), {90, 90, 90}, 1));
  return mesh;
}

Mesh bracket()
{
  const cv::Vec3b blue(150, 85, 40), steel(165, 165, 160);
  // An angle of two unequal arms, seen from above, with a step at one and a slanted end at the other.
  Mesh mesh = prism({{-0.05, -0.04},
                     {0.06, -0.04},
                     {0.06, -0.015},
                     {0.035, -0.015},
                     {0.025, -0.02},
                     {-0.02, -0.02},
                     {-0.02, 0.03},
                     {-0.035, 0.045},
                     {-0.05, 0.045}},
                    0.0, 0.045, blue);
  const auto at = [](Mesh part, const cv::Vec3f& where)
  {
    for (cv::Vec3f& vertex : part.vertices)
      vertex += where;
    return part;
  };
  const auto pin = [&](double radius, double low, double high)
  {
    return lathe({{{{0, low}, {radius, low}}, steel},
                  {{{radius, low}, {radius, high}}, steel},
                  {{{radius, high}, {0, high}}, steel}},
                 24);
  };
  add(mesh, at(pin(0.009, 0.03, 0.07), {0.045F, -0.0275F, 0.0F}));
  add(mesh, at(pin(0.012, 0.03, 0.055), {-0.035F, 0.015F, 0.0F}));
  return mesh;
}

}  // namespace robot_vision::samples
