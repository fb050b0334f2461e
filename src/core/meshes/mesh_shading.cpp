#include "mesh_shading.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "shade_kernels.hpp"

namespace robot_vision
{
namespace
{

constexpr float kAmbient = 0.35F;  // of the light that comes from all around, of all light

float at(const RayFunction& f, float x, float y)
{
  return f.x * x + (f.y * y + f.one);
}

/// The color of a texture at a pixel; `step` is between the rays of neighbouring pixels.
cv::Vec3f textureColor(const TextureShade& shade, float x, float y, float w, const cv::Vec2f& step)
{
  const float u = at(shade.u, x, y) * w, v = at(shade.v, x, y) * w;
  const cv::Size size = shade.texture->size();
  const auto width = static_cast<float>(size.width), height = static_cast<float>(size.height);
  const auto texels = [&](float du, float dv, float per_pixel)  // between neighbouring pixels, squared
  { return (du * du * width * width + dv * dv * height * height) * per_pixel * per_pixel; };
  const float across = texels(shade.u.x - u * shade.inverse.x, shade.v.x - v * shade.inverse.x, w * step[0]);
  const float down = texels(shade.u.y - u * shade.inverse.y, shade.v.y - v * shade.inverse.y, w * step[1]);
  return shade.texture->color(u, v, std::max(across, down));
}

uchar toByte(float color)
{
  return static_cast<uchar>(std::min(static_cast<int>(color + 0.5F), 255));
}

/// Shades the pixels of one drawing, row by row.
class Painter
{
public:
  Painter(const MeshLook& look, const SeenVertex* vertices, const SeenTriangles& triangles, const Raster& raster,
          const Shading& shading, ShadingScratch& scratch, MeshView& view)
    : look_(look),
      raster_(raster),
      shading_(shading),
      scratch_(scratch),
      view_(view),
      frame_{shading.to_ray(0, 0), shading.to_ray(0, 1), shading.to_ray(0, 2), shading.to_ray(1, 1),
             shading.to_ray(1, 2)}
  {
    if (view.normals.empty() && view.bgr.empty()) return;
    scratch.shades.resize(static_cast<std::size_t>(raster.columns));
    for (std::vector<float>& numbers : scratch.numbers)
      numbers.resize(static_cast<std::size_t>(raster.columns));
    for (int i = 0; i < 3; ++i)
    {
      normals_[i] = scratch.numbers[i].data();
      channels_[i] = scratch.numbers[3 + i].data();
    }
    light_ = scratch.numbers[6].data();
    findTriangles(triangles);
    makeShades({vertices, triangles.corners, scratch.triangles.data(), static_cast<int>(scratch.triangles.size())});
  }

  /// Depths and ids of a row.
  void place(int row) const
  {
    const int* drawn = raster_.drawn + begin(row);
    const float* inverse = raster_.inverse + begin(row);
    float* depth = view_.depth.ptr<float>(shading_.place.y + row) + shading_.place.x;
    for (int i = 0; i < shading_.place.width; ++i)
      depth[i] = drawn[i] >= 0 ? 1.0F / inverse[i] : depth[i];
    if (view_.ids.empty()) return;
    auto* ids = view_.ids.ptr<std::uint16_t>(shading_.place.y + row) + shading_.place.x;
    const auto id = static_cast<std::uint16_t>(shading_.id);
    for (int i = 0; i < shading_.place.width; ++i)
      ids[i] = drawn[i] >= 0 ? id : ids[i];
  }

  /// Normals and colors of a row.
  void paint(int row)
  {
    const cv::Range seen = findShades(raster_.drawn + begin(row));
    if (seen.empty()) return;
    const ShadedRow pixels = {seen.size(),
                              scratch_.shades.data() + seen.start,
                              raster_.inverse + begin(row) + seen.start,
                              raster_.xs + row * raster_.ray_step + seen.start,
                              raster_.ys != nullptr ? raster_.ys + row * raster_.ray_step + seen.start : nullptr,
                              static_cast<float>(raster_.top + row)};
    if (look_.normals[0].empty())
      kernels<ShadeKernels>().flatNormals(pixels, scratch_.surfaces.data(), normals_);
    else
      kernels<ShadeKernels>().normals(pixels, frame_, scratch_.surfaces.data(), normals_);
    const int* drawn = raster_.drawn + begin(row) + seen.start;
    const cv::Point first(shading_.place.x + seen.start, shading_.place.y + row);
    if (!view_.normals.empty()) writeNormals(drawn, seen.size(), view_.normals.ptr<cv::Vec3f>(first.y) + first.x);
    if (!view_.bgr.empty()) writeColors(pixels, drawn, view_.bgr.ptr<cv::Vec3b>(first.y) + first.x);
  }

private:
  std::ptrdiff_t begin(int row) const { return static_cast<std::ptrdiff_t>(row) * raster_.columns; }

  /// Finds the triangles that are seen, without branches that are hard to foresee.
  void findTriangles(const SeenTriangles& triangles)
  {
    const auto count = static_cast<std::size_t>(triangles.count);
    std::vector<int>& known = scratch_.known;  // the first entry is that of pixels without a triangle
    known.assign(count + 1, 0);
    for (int row = 0; row < shading_.place.height; ++row)
    {
      const int* drawn = raster_.drawn + begin(row);
      for (int i = 0; i < shading_.place.width; ++i)
        known[static_cast<std::size_t>(drawn[i] + 1)] = 1;
    }
    known[0] = 0;
    scratch_.triangles.resize(count + 1);
    int found = 0;
    for (std::size_t i = 0; i < count; ++i)
    {
      const int seen = known[i + 1];
      known[i + 1] = found;
      scratch_.triangles[static_cast<std::size_t>(found)] = triangles.drawn[i];
      found += seen;
    }
    scratch_.triangles.resize(static_cast<std::size_t>(found));
  }

  void makeShades(const ShadedTriangles& seen)
  {
    const ShadeKernels& make = kernels<ShadeKernels>();
    const auto count = static_cast<std::size_t>(seen.count);
    scratch_.surfaces.resize(count);
    if (!look_.normals[0].empty() && count > 0)
      make.functions(seen, scratch_.normals.data(), scratch_.surfaces[0].normal, sizeof(SurfaceShade) / sizeof(float));
    for (std::size_t i = 0; i < count; ++i)
      turnToCamera(seen.vertices, scratch_.triangles[i], scratch_.surfaces[i]);
    if (view_.bgr.empty()) return;
    scratch_.colors.resize(look_.colors.empty() ? 0 : count);
    if (!scratch_.colors.empty())
      make.functions(seen, look_.colors.data(), scratch_.colors[0].channels, sizeof(ColorShade) / sizeof(float));
    scratch_.textures.clear();
    if (!look_.triangle_textures.empty())
      for (const int triangle : scratch_.triangles)
        scratch_.textures.push_back(textureShade(look_, seen.vertices, triangle));
  }

  /// Gives a surface the normal of its triangle, and turns all of its normals to the side that is seen.
  void turnToCamera(const SeenVertex* vertices, int triangle, SurfaceShade& surface) const
  {
    const cv::Vec3f& flat = look_.flat_normals[static_cast<std::size_t>(triangle)];
    const cv::Matx33f& r = shading_.rotation;
    for (int i = 0; i < 3; ++i)
      surface.flat[i] = r(i, 0) * flat[0] + r(i, 1) * flat[1] + r(i, 2) * flat[2];
    const int outside = look_.outsides[static_cast<std::size_t>(triangle)];
    if (outside > 0 || (outside == 0 && !isBackSeen(vertices, triangle, surface))) return;
    for (int i = 0; i < 3; ++i)
    {
      surface.flat[i] = -surface.flat[i];
      surface.normal[i] = {-surface.normal[i].x, -surface.normal[i].y, -surface.normal[i].one};
    }
  }

  bool isBackSeen(const SeenVertex* vertices, int triangle, const SurfaceShade& surface) const
  {
    const SeenVertex& corner = vertices[look_.triangles[static_cast<std::size_t>(triangle)][0]];
    const cv::Vec3f point = shading_.to_ray * cv::Vec3f(static_cast<float>(corner.x), static_cast<float>(corner.y),
                                                        static_cast<float>(corner.w));
    return surface.flat[0] * point[0] + surface.flat[1] * point[1] + surface.flat[2] * point[2] > 0.0F;
  }

  /// Fills the shades of a row. Returns the pixels from the first that triangles were drawn to up to the last.
  cv::Range findShades(const int* drawn)
  {
    cv::Range seen(0, shading_.place.width);
    while (seen.start < seen.end && drawn[seen.start] < 0)
      ++seen.start;
    while (seen.start < seen.end && drawn[seen.end - 1] < 0)
      --seen.end;
    const int* known = scratch_.known.data() + 1;
    for (int i = seen.start; i < seen.end; ++i)
      scratch_.shades[static_cast<std::size_t>(i)] = known[drawn[i]];
    return seen;
  }

  void writeNormals(const int* drawn, int count, cv::Vec3f* normals) const
  {
    for (int i = 0; i < count; ++i)
      if (drawn[i] >= 0) normals[i] = {normals_[0][i], normals_[1][i], normals_[2][i]};
  }

  void writeColors(const ShadedRow& pixels, const int* drawn, cv::Vec3b* bgr) const
  {
    const bool at_camera = shading_.to_light == cv::Vec3f();
    kernels<ShadeKernels>().light(pixels, frame_, normals_, at_camera ? nullptr : shading_.to_light.val, light_);
    for (int i = 0; i < pixels.count; ++i)
      light_[i] = kAmbient + (1.0F - kAmbient) * light_[i];
    if (!look_.colors.empty())
      kernels<ShadeKernels>().colors(pixels, scratch_.colors.data(), light_, channels_);
    else
      for (int channel = 0; channel < 3; ++channel)
        std::transform(light_, light_ + pixels.count, channels_[channel],
                       [&](float light) { return light * look_.color[channel]; });
    if (!scratch_.textures.empty()) lookUpTextures(pixels, drawn);
    for (int i = 0; i < pixels.count; ++i)
      if (drawn[i] >= 0) bgr[i] = {toByte(channels_[0][i]), toByte(channels_[1][i]), toByte(channels_[2][i])};
  }

  void lookUpTextures(const ShadedRow& pixels, const int* drawn) const
  {
    for (int i = 0; i < pixels.count; ++i)
    {
      const TextureShade& shade = scratch_.textures[static_cast<std::size_t>(pixels.shades[i])];
      if (drawn[i] < 0 || shade.texture == nullptr) continue;
      const float y = pixels.ys != nullptr ? pixels.ys[i] : pixels.y;
      const cv::Vec3f color = textureColor(shade, pixels.xs[i], y, 1.0F / pixels.inverse[i], shading_.step);
      for (int channel = 0; channel < 3; ++channel)
        channels_[channel][i] = color[channel] * light_[i];
    }
  }

  const MeshLook& look_;
  const Raster& raster_;
  const Shading& shading_;
  ShadingScratch& scratch_;
  MeshView& view_;
  RayFrame frame_;
  float *normals_[3], *channels_[3], *light_;  // of a row, in the scratch
};

}  // namespace

void shade(const MeshLook& look, const SeenVertex* vertices, const SeenTriangles& triangles, const Raster& raster,
           const Shading& shading, ShadingScratch& scratch, MeshView& view)
{
  const bool painted = !view.normals.empty() || !view.bgr.empty();
  if (painted && !look.normals[0].empty())
  {
    const float* from[3] = {look.normals[0].data(), look.normals[1].data(), look.normals[2].data()};
    scratch.normals.resize(3 * look.normals[0].size());
    kernels<VertexKernels>().rotate(from, static_cast<int>(look.normals[0].size()), shading.rotation.val,
                                    scratch.normals.data());
  }
  Painter painter(look, vertices, triangles, raster, shading, scratch, view);
  for (int row = 0; row < shading.place.height; ++row)
  {
    painter.place(row);
    if (painted) painter.paint(row);
  }
}

}  // namespace robot_vision
