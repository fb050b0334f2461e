#include "robot_vision/meshes/sample_meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/core/affine.hpp>

#include "core/meshes/mesh_surface.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

TEST(SampleMeshes, areClosedAndStandOnTheirOrigin)
{
  for (const std::string& name : sampleMeshNames())
  {
    const SampleMesh sample = sampleMesh(name);
    EXPECT_EQ(sample.name, name);
    EXPECT_EQ(refusal([&] { validate(sample.mesh); }), "") << name;
    const MeshSurface surface = meshSurface(sample.mesh);
    EXPECT_EQ(surface.open_edges, 0) << name;
    EXPECT_EQ(surface.outsides, std::vector<std::int8_t>(sample.mesh.triangles.size(), 1)) << name;
    const MeshExtent extent = meshExtent(sample.mesh);
    EXPECT_NEAR(extent.center[2] - extent.size[2] / 2.0, 0.0, 0.0005) << name;
    const Mesh again = sampleMesh(name).mesh;
    EXPECT_TRUE(again.vertices == sample.mesh.vertices && again.triangles == sample.mesh.triangles) << name;
  }
  EXPECT_EQ(refusal([] { sampleMesh("cube"); }),
            "sample mesh is 'cube', must be one of bottle, box, bracket, can, drill, duck, mug, nut");
}

TEST(SampleMeshes, haveNormalsThatAreThoseOfTheirSurface)
{
  for (const std::string& name : sampleMeshNames())
  {
    const Mesh mesh = sampleMesh(name).mesh;
    if (mesh.normals.empty()) continue;
    for (const cv::Vec3i& triangle : mesh.triangles)
    {
      const auto corner = [&](int k) { return cv::Vec3d(mesh.vertices[static_cast<std::size_t>(triangle[k])]); };
      const cv::Vec3d flat = cv::normalize((corner(1) - corner(0)).cross(corner(2) - corner(0)));
      for (const int vertex : triangle.val)
      {
        const cv::Vec3d normal = mesh.normals[static_cast<std::size_t>(vertex)];
        ASSERT_NEAR(cv::norm(normal), 1.0, 1e-5) << name;
        ASSERT_GT(normal.dot(flat), 0.2) << name << " at " << corner(0);
      }
    }
  }
}

TEST(SampleMeshes, lookTheSameWhenTheyAreTurnedByTheirSymmetries)
{
  for (const std::string& name : sampleMeshNames())
  {
    const SampleMesh sample = sampleMesh(name);
    const cv::Vec3d center = meshExtent(sample.mesh).center;
    for (const SampleSymmetry& symmetry : sample.symmetries)
    {
      const int fold = symmetry.fold == 0 ? 48 : symmetry.fold;  // the segments of what is round
      const cv::Affine3d turn(symmetry.axis * (2.0 * CV_PI / fold));
      for (const cv::Vec3f& vertex : sample.mesh.vertices)
      {
        const cv::Vec3d turned = turn * (cv::Vec3d(vertex) - center) + center;
        double nearest = 1.0;
        for (const cv::Vec3f& other : sample.mesh.vertices)
          nearest = std::min(nearest, cv::norm(cv::Vec3d(other) - turned, cv::NORM_L2SQR));
        ASSERT_LT(nearest, 1e-12) << name;
      }
    }
  }
}
