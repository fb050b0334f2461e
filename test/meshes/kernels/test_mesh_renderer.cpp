#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/meshes/mesh_textures.hpp"
#include "core/simd/instruction_sets.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"
#include "support/ray_caster.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const cv::Matx33d kK(60.0, 0.5, 33.2, 0.0, 61.0, 24.9, 0.0, 0.0, 1.0);
const cv::Rect kImage(0, 0, 67, 49);

CameraModel lens()
{
  CameraModel camera;
  camera.width = kImage.width;
  camera.height = kImage.height;
  camera.K = cv::Matx33d(60.0, 0.0, 33.2, 0.0, 61.0, 24.9, 0.0, 0.0, 1.0);
  camera.D = {-0.2, 0.08, 0.002, -0.001, 0.0};
  return camera;
}

/// The ray through the middle of a pixel.
cv::Vec3d rayOf(const cv::Matx33d& K, double x, double y)
{
  return K.inv() * cv::Vec3d(x, y, 1.0);
}

/// A mesh a little larger than its image, turned to a different side for each number.
cv::Affine3d poseOf(const Mesh& mesh, int number)
{
  const MeshExtent extent = meshExtent(mesh);
  const cv::Affine3d turned(cv::Vec3d(0.9 * number, 1.7 - 0.4 * number, 0.3 * number));
  const cv::Vec3d place(0.1 * extent.radius, -0.05 * extent.radius, (1.9 + 0.4 * number) * extent.radius);
  return cv::Affine3d(cv::Matx33d::eye(), place) * turned * cv::Affine3d(cv::Matx33d::eye(), -extent.center);
}

/// Compares a view with rays. Where a ray passes a triangle within a millionth of its size, both may be right.
template <class Ray>
void expectRaysMeetTheSame(const Mesh& mesh, const cv::Affine3d& pose, const MeshView& view, const Ray& ray)
{
  int unsure = 0;
  for (int y = 0; y < view.depth.rows; ++y)
    for (int x = 0; x < view.depth.cols; ++x)
    {
      const RayHit hit = castRay(mesh, pose, ray(x, y));
      const double drawn = view.depth.at<float>(y, x);
      const bool same = hit.triangle < 0 ? std::isnan(drawn) : std::abs(drawn / hit.z - 1.0) < 1e-5;
      if (hit.edge < 1e-4)
        unsure += same ? 0 : 1;
      else
        ASSERT_TRUE(same) << "pixel " << x << ", " << y << ": " << drawn << " m, must be " << hit.z;
    }
  EXPECT_LE(unsure, 2);
}

class MeshRendererOf : public testing::TestWithParam<const char*>
{
};

}  // namespace

TEST_P(MeshRendererOf, drawsWhatTheRayOfEachPixelMeetsFirst)
{
  const Mesh mesh = sampleMesh(GetParam()).mesh;
  const MeshRenderer renderer(mesh);
  MeshView view;
  for (int number = 0; number < 3; ++number)
  {
    const cv::Affine3d pose = poseOf(mesh, number);
    renderer.render(kK, pose, kImage, view);
    expectRaysMeetTheSame(mesh, pose, view, [](int x, int y) { return rayOf(kK, x, y); });
  }
}

TEST_P(MeshRendererOf, drawsTheSameThroughALens)
{
  const Mesh mesh = sampleMesh(GetParam()).mesh;
  const CameraModel camera = lens();
  const cv::Affine3d pose = poseOf(mesh, 1);
  MeshView view;
  MeshRenderer(mesh).render(MeshCamera(camera), pose, kImage, view);
  expectRaysMeetTheSame(mesh, pose, view,
                        [&](double x, double y)
                        {
                          const cv::Point2d ray = camera.ray({x, y});
                          return cv::Vec3d(ray.x, ray.y, 1.0);
                        });
}

INSTANTIATE_TEST_SUITE_P(Samples, MeshRendererOf, testing::Values("box", "bracket", "nut"),
                         [](const auto& info) { return std::string(info.param); });

TEST(MeshRenderer, cutsWhatPassesTheCamera)
{
  const float far = 9.9F;                  // m, to all sides
  for (const float below : {1.0F, 3e-4F})  // m, of the camera, which looks forward; of the second a part is too near
  {
    Mesh floor;
    floor.vertices = {{-far, below, -far}, {far, below, -far}, {far, below, far}, {-far, below, far}};
    floor.triangles = {{0, 2, 1}, {0, 3, 2}};
    MeshView view;
    MeshRenderer(floor).render(kK, cv::Affine3d(), kImage, view);
    for (int y = 0; y < kImage.height; ++y)
      for (int x = 0; x < kImage.width; ++x)
      {
        const cv::Vec3d ray = rayOf(kK, x, y);
        const double z = ray[1] > 0.0 ? below / ray[1] : std::numeric_limits<double>::infinity();
        const bool seen = z <= far && std::abs(ray[0]) * z <= far && z >= MeshRenderer::kNearest;
        const double drawn = view.depth.at<float>(y, x);
        ASSERT_TRUE(seen ? std::abs(drawn / z - 1.0) < 1e-5 : std::isnan(drawn)) << x << ", " << y << ": " << drawn;
      }
  }
}

TEST(MeshRenderer, drawsEachPixelOfASurfaceOnce)
{
  // A fan of triangles around a point that is exactly in the middle of a pixel, with sides through middles of others.
  const std::array<cv::Vec2f, 8> around = {
      {{20, 0}, {20, 20}, {0, 20}, {-20, 20}, {-20, 0}, {-20, -20}, {0, -20}, {20, -20}}};
  cv::Mat times = cv::Mat::zeros(kImage.size(), CV_8UC1);
  const cv::Matx33d K(1, 0, 0, 0, 1, 0, 0, 0, 1);
  MeshView view;
  for (std::size_t i = 0; i < around.size(); ++i)
  {
    Mesh mesh;
    mesh.vertices = {{30, 24, 1}};
    for (const cv::Vec2f& one : around)
      mesh.vertices.emplace_back(30 + one[0], 24 + one[1], 1.0F);
    mesh.triangles = {{0, static_cast<int>(i) + 1, static_cast<int>((i + 1) % around.size()) + 1}};
    MeshRenderer(mesh).render(K, cv::Affine3d(), kImage, view);
    times += (view.depth > 0.0) / 255;
  }
  EXPECT_EQ(cv::countNonZero(times > 1), 0);
  EXPECT_EQ(cv::countNonZero(times(cv::Rect(11, 5, 39, 39)) != 1), 0);
}

TEST(MeshRenderer, hasNoGapsBetweenTriangles)
{
  const Mesh mesh = sampleMesh("can").mesh;
  const MeshRenderer renderer(mesh);
  MeshView view;
  for (int number = 0; number < 20; ++number)  // the axis in the middle: within half its radius there is only the can
  {
    const cv::Affine3d pose = cv::Affine3d(cv::Matx33d::eye(), cv::Vec3d(0, 0, 0.3 + 0.02 * number)) *
                              cv::Affine3d(cv::Vec3d(0.31 * number, 0.17 * number, 0.0)) *
                              cv::Affine3d(cv::Matx33d::eye(), -meshExtent(mesh).center);
    renderer.render(cv::Matx33d(900, 0, 30, 0, 900, 20, 0, 0, 1), pose, cv::Rect(0, 0, 61, 41), view);
    EXPECT_EQ(cv::countNonZero(view.depth > 0.0), 61 * 41) << number;
  }
}

TEST(MeshRenderer, drawsTheSameBitsWithEachInstructionSet)
{
  const MeshRenderer renderer(sampleMesh("duck").mesh);
  const InstructionSet set = currentSet();
  RenderParts parts;
  parts.bgr = parts.normals = true;
  for (const bool distorted : {false, true})
  {
    MeshView view, baseline;
    const MeshCamera camera = distorted ? MeshCamera(lens()) : MeshCamera(kK);
    const cv::Affine3d pose = poseOf(sampleMesh("duck").mesh, 1);
    chooseSet(InstructionSet::kBaseline);
    renderer.render(camera, pose, kImage, baseline, parts);
    chooseSet(set);
    renderer.render(camera, pose, kImage, view, parts);
    EXPECT_EQ(std::memcmp(view.depth.data, baseline.depth.data, view.depth.total() * view.depth.elemSize()), 0);
    EXPECT_EQ(std::memcmp(view.normals.data, baseline.normals.data, view.normals.total() * view.normals.elemSize()), 0);
    EXPECT_EQ(cv::norm(view.bgr, baseline.bgr, cv::NORM_INF), 0.0);
  }
}

TEST(MeshRenderer, drawsTheRegionsOfAnImageAsTheWhole)
{
  const Mesh mesh = sampleMesh("mug").mesh;
  const MeshRenderer renderer(mesh);
  const cv::Affine3d pose = poseOf(mesh, 2);
  RenderParts parts;
  parts.bgr = parts.normals = parts.ids = true;
  for (const bool distorted : {false, true})
  {
    const MeshCamera camera = distorted ? MeshCamera(lens()) : MeshCamera(kK);
    MeshView whole, view;
    renderer.render(camera, pose, kImage, whole, parts);
    for (const cv::Rect& region : {cv::Rect(20, 10, 1, 1), cv::Rect(13, 9, 30, 17), cv::Rect(41, 3, 26, 46)})
    {
      renderer.render(camera, pose, region, view, parts);
      EXPECT_EQ(cv::norm(view.ids, whole.ids(region), cv::NORM_INF), 0.0);
      EXPECT_LE(cv::norm(view.bgr, whole.bgr(region), cv::NORM_INF), 1.0);  // as numbers are rounded
      const cv::Mat seen = view.ids > 0;
      EXPECT_LT(cv::norm(view.depth, whole.depth(region), cv::NORM_INF, seen), 1e-6);
      EXPECT_LT(cv::norm(view.normals, whole.normals(region), cv::NORM_INF, seen), 1e-4);
    }
  }
}

TEST(MeshRenderer, drawsToNoImageOfAnotherSize)
{
  const MeshRenderer renderer(sampleMesh("box").mesh);
  const cv::Affine3d pose(cv::Matx33d::eye(), cv::Vec3d(0.0, 0.0, 0.5));
  MeshView view;
  RenderParts parts;
  parts.bgr = true;
  renderer.render(kK, pose, cv::Rect(0, 0, 10, 10), view, parts);
  view.depth = cv::Mat(kImage.size(), CV_32FC1, cv::Scalar::all(1.0));
  EXPECT_EQ(refusal([&] { renderer.merge(kK, pose, kImage, view, RenderParts(), 1); }),
            "bgr is 10x10, must be 67x49 of the type that render() makes");
}

TEST(MeshTexture, hasAColorForAnyNumber)
{
  const MeshTexture texture(cv::Mat(8, 6, CV_8UC3, cv::Scalar(10, 20, 30)));
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  for (const float number : {3e9F, -3e9F, 5e8F, 1e30F, kInfinity, -kInfinity, kNan})
    for (const float texels : {0.0F, 1e30F, kInfinity, kNan})
    {
      EXPECT_EQ(texture.color(number, 0.3F, texels), cv::Vec3f(10, 20, 30)) << number << " " << texels;
      EXPECT_EQ(texture.color(0.3F, number, texels), cv::Vec3f(10, 20, 30)) << number << " " << texels;
    }
}
