#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <vector>

#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/recognition/object_shape.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"
#include "robot_vision/scene/depth_noise.hpp"

/// A camera like that of a Kinect, or the middle of its image.
inline robot_vision::CameraModel objectCamera(int width = 640, int height = 480, double f = 525.0)
{
  return {width, height, {f, 0, 0.5 * width - 0.5, 0, f, 0.5 * height - 0.5, 0, 0, 1}, {}};
}

/// A box of this size (m) around the origin, whose triangles are flat.
inline robot_vision::Mesh boxMesh(const cv::Vec3f& size, const cv::Vec3b& color, const cv::Vec3f& middle = {})
{
  robot_vision::Mesh mesh;
  mesh.color = color;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(middle[0] + ((i & 1) != 0 ? 0.5F : -0.5F) * size[0],
                               middle[1] + ((i & 2) != 0 ? 0.5F : -0.5F) * size[1],
                               middle[2] + ((i & 4) != 0 ? 0.5F : -0.5F) * size[2]);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline void append(robot_vision::Mesh& mesh, const robot_vision::Mesh& other)
{
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const cv::Vec3i& triangle : other.triangles)
    mesh.triangles.emplace_back(triangle[0] + first, triangle[1] + first, triangle[2] + first);
}

/// A block without any symmetry: an L with legs of different lengths, and a knob on one of them. Its origin is not in
/// its middle.
inline robot_vision::Mesh lBlock(const cv::Vec3b& color = {40, 60, 200})
{
  robot_vision::Mesh mesh = boxMesh({0.12F, 0.04F, 0.05F}, color, {0.06F, 0.02F, 0.025F});
  append(mesh, boxMesh({0.04F, 0.05F, 0.05F}, color, {0.02F, 0.065F, 0.025F}));
  append(mesh, boxMesh({0.03F, 0.03F, 0.03F}, color, {0.095F, 0.02F, 0.065F}));
  return mesh;
}

/// A round rod along z, of this radius and height, with so many flat sides.
inline robot_vision::Mesh cylinderMesh(float radius, float height, int sides, const cv::Vec3b& color)
{
  robot_vision::Mesh mesh;
  mesh.color = color;
  for (int i = 0; i < sides; ++i)
    for (const float z : {-0.5F * height, 0.5F * height})
    {
      const double angle = 2.0 * CV_PI * i / sides;
      mesh.vertices.emplace_back(radius * static_cast<float>(std::cos(angle)),
                                 radius * static_cast<float>(std::sin(angle)), z);
    }
  mesh.vertices.emplace_back(0.0F, 0.0F, -0.5F * height);
  mesh.vertices.emplace_back(0.0F, 0.0F, 0.5F * height);
  for (int i = 0; i < sides; ++i)
  {
    const int a = 2 * i, b = 2 * ((i + 1) % sides), bottom = 2 * sides;
    mesh.triangles.emplace_back(a, b, a + 1);
    mesh.triangles.emplace_back(b, b + 1, a + 1);
    mesh.triangles.emplace_back(bottom, b, a);
    mesh.triangles.emplace_back(bottom + 1, a + 1, b + 1);
  }
  return mesh;
}

/// The mirror image of a mesh.
inline robot_vision::Mesh mirrored(robot_vision::Mesh mesh)
{
  for (cv::Vec3f& vertex : mesh.vertices)
    vertex[0] = -vertex[0];
  for (cv::Vec3i& triangle : mesh.triangles)
    std::swap(triangle[0], triangle[1]);
  for (cv::Vec3f& normal : mesh.normals)
    normal[0] = -normal[0];
  return mesh;
}

/// Things on a table, drawn as a camera sees them.
class ObjectScene
{
public:
  explicit ObjectScene(const robot_vision::CameraModel& camera = objectCamera()) : camera_(camera) {}

  void add(const robot_vision::Mesh& mesh, const cv::Affine3d& pose)
  {
    things_.push_back({std::make_shared<robot_vision::MeshRenderer>(mesh), pose});
  }

  /// The plane below which nothing is, 2 m wide, through a point and with a normal.
  void addTable(const cv::Vec3d& point, const cv::Vec3d& normal, const cv::Vec3b& color = {150, 170, 180})
  {
    const cv::Vec3d z = cv::normalize(normal), x = cv::normalize(cv::Vec3d(1, 0.01, 0).cross(z)), y = z.cross(x);
    const cv::Matx33d rotation(x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]);
    add(boxMesh({2.0F, 2.0F, 0.02F}, color, {0.0F, 0.0F, -0.01F}), {rotation, point});
  }

  /// The frame of this number, with the noise of a sensor and, of the colors, a deviation of 3.
  void draw(robot_vision::DepthSensor sensor, int number, cv::Mat& bgr, cv::Mat& depth) const
  {
    robot_vision::MeshView view;
    robot_vision::RenderParts parts;
    parts.bgr = true;
    const cv::Rect all(0, 0, camera_.width, camera_.height);
    bool is_first = true;
    for (const Thing& thing : things_)
    {
      if (is_first)
        thing.renderer->render(camera_.K, thing.pose, all, view, parts);
      else
        thing.renderer->merge(camera_.K, thing.pose, all, view, parts, 0);
      is_first = false;
    }
    cv::RNG random(static_cast<std::uint64_t>(number) + 77);
    cv::Mat noise(all.size(), CV_16SC3), noisy;
    random.fill(noise, cv::RNG::NORMAL, 0, 3);
    view.bgr.setTo(cv::Scalar(90, 110, 100), view.depth != view.depth);
    view.bgr.convertTo(noisy, CV_16SC3);
    noisy += noise;
    noisy.convertTo(bgr, CV_8UC3);
    robot_vision::DepthNoise(sensor, camera_, 11).apply(number, view.depth, cv::Mat(), depth);
  }

  const robot_vision::CameraModel& camera() const { return camera_; }

private:
  struct Thing
  {
    std::shared_ptr<robot_vision::MeshRenderer> renderer;
    cv::Affine3d pose;
  };

  robot_vision::CameraModel camera_;
  std::vector<Thing> things_;
};

/// Any rotation, all alike.
inline cv::Matx33d anyRotation(cv::RNG& random)
{
  cv::Vec4d q;
  for (int i = 0; i < 4; ++i)
    q[i] = random.gaussian(1.0);
  q = cv::normalize(q);
  const double angle = 2.0 * std::acos(q[0]), length = std::sqrt(1.0 - q[0] * q[0]);
  const cv::Vec3d axis(q[1], q[2], q[3]);
  return cv::Affine3d(length > 1e-9 ? axis * (angle / length) : cv::Vec3d(), cv::Vec3d()).rotation();
}

/// A pose that is off by normally distributed shifts and rotations of the point `center` of the object's frame.
inline cv::Affine3d disturbed(const cv::Affine3d& pose, const cv::Vec3d& center, double shift, double turn,
                              cv::RNG& random)
{
  cv::Vec3d by, about;
  for (int i = 0; i < 3; ++i)
  {
    by[i] = random.gaussian(shift);
    about[i] = random.gaussian(turn);
  }
  const cv::Matx33d rotation = cv::Affine3d(about).rotation() * pose.rotation();
  return {rotation, pose * center + by - rotation * center};
}

/// The angle (degrees) between two poses, and the distance (mm) of a point of the object.
inline double angleBetween(const cv::Affine3d& a, const cv::Affine3d& b)
{
  return cv::norm(cv::Affine3d(a.rotation() * b.rotation().t()).rvec()) * 180.0 / CV_PI;
}

inline double distanceBetween(const cv::Affine3d& a, const cv::Affine3d& b, const cv::Vec3d& point)
{
  return cv::norm(a * point - b * point) * 1000.0;
}
