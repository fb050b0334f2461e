#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <utility>
#include <vector>

#include "robot_vision/depth/depth_error.hpp"
#include "robot_vision/meshes/mesh_reader.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"
#include "robot_vision/recognition/object_shape.hpp"
#include "robot_vision/recognition/symmetry.hpp"
#include "support/cluttered_scenes.hpp"

/// What is tried with objects in cluttered scenes, by programs that measure or fit recognition.
namespace trials
{

/// A mesh to look for.
struct Thing
{
  std::string name;
  robot_vision::Mesh mesh;
  std::vector<robot_vision::Symmetry> symmetries;
};

/// One that is looked for, among others.
struct Object : Thing
{
  std::shared_ptr<const robot_vision::ObjectShape> shape;
  std::unique_ptr<ClutteredScenes> scenes;
  std::vector<cv::Vec3f> points;  // m, of its surface
};

/// What a sensor of the scenes is like, as docs/depth.md says: with parameters of another one, its noise is taken for
/// other surfaces.
inline robot_vision::DepthErrorParams errorsOf(robot_vision::DepthSensor sensor)
{
  robot_vision::DepthErrorParams errors;
  if (sensor != robot_vision::DepthSensor::kStereo) return errors;
  errors.depth_noise = 0.0015;
  errors.depth_noise_growth = 0.0055;
  errors.depth_step = 0.0012;
  errors.depth_correlation = 25;
  return errors;
}

inline std::vector<Thing> samples()
{
  std::vector<Thing> things;
  for (const std::string& name : robot_vision::sampleMeshNames())
  {
    const robot_vision::SampleMesh sample = robot_vision::sampleMesh(name);
    Thing thing{name, sample.mesh, {}};
    for (const robot_vision::SampleSymmetry& symmetry : sample.symmetries)
      thing.symmetries.push_back({symmetry.axis, symmetry.fold});
    things.push_back(std::move(thing));
  }
  return things;
}

/// Six of the models of Debian's package assimp-testmodels, in its folder: what nobody has made for us. They are of all
/// sizes, and get the diameter (m) of a thing that one can handle.
inline std::vector<Thing> testModels(const std::string& folder, double diameter = 0.2)
{
  const std::array<std::array<const char*, 3>, 6> files = {
      {{"duck", "Collada/duck.dae", "m"},
       {"spider", "OBJ/spider.obj", "mm"},
       {"boar", "OBJ/WusonOBJ.obj", "cm"},
       {"monkey", "BLEND/Suzanne_248.blend", "cm"},
       {"engine", "glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb", "mm"},
       {"truck", "glTF/CesiumMilkTruck/CesiumMilkTruck.gltf", "cm"}}};
  std::vector<Thing> things;
  for (const auto& [name, file, unit] : files)
  {
    Thing thing{name, robot_vision::readMesh(folder + "/" + file, unit).mesh, {}};
    const auto scale = static_cast<float>(diameter / robot_vision::meshExtent(thing.mesh).diameter);
    for (cv::Vec3f& vertex : thing.mesh.vertices)
      vertex *= scale;
    things.push_back(std::move(thing));
  }
  return things;
}

/// All things, each in scenes of its own among the others, which are the same for the same seed.
inline std::vector<Object> objectsOf(const std::vector<Thing>& things, std::uint64_t seed)
{
  std::vector<Object> objects;
  for (const Thing& thing : things)
  {
    Object object{thing, nullptr, nullptr, {}};
    object.shape = std::make_shared<robot_vision::ObjectShape>(object.mesh, object.symmetries);
    std::vector<robot_vision::Mesh> others;
    for (const Thing& other : things)
      if (other.name != thing.name) others.push_back(other.mesh);
    object.scenes = std::make_unique<ClutteredScenes>(object.mesh, others, seed);
    const std::size_t step = std::max<std::size_t>(1, object.mesh.vertices.size() / 300);
    for (std::size_t i = 0; i < object.mesh.vertices.size(); i += step)
      object.points.push_back(object.mesh.vertices[i]);
    objects.push_back(std::move(object));
  }
  return objects;
}

/// The mean distance (m) of the points of an object in two poses: of each from itself (ADD) or, for one that looks the
/// same in several poses, from the nearest one (ADD-S).
inline double meanDistance(const Object& object, const cv::Affine3d& found, const cv::Affine3d& truth)
{
  std::vector<cv::Vec3d> there;
  for (const cv::Vec3f& point : object.points)
    there.push_back(truth * cv::Vec3d(point));
  double sum = 0.0;
  for (std::size_t i = 0; i < there.size(); ++i)
  {
    const cv::Vec3d place = found * cv::Vec3d(object.points[i]);
    double nearest = cv::norm(place - there[i]);
    for (std::size_t j = 0; j < there.size() && !object.symmetries.empty(); ++j)
      nearest = std::min(nearest, cv::norm(place - there[j]));
    sum += nearest;
  }
  return sum / static_cast<double>(there.size());
}

/// Whether two pixels of a drawn object are at most `gate` (m) apart and, if they count, have about the same color.
inline bool isAlike(const robot_vision::MeshView& a, const robot_vision::MeshView& b, int x, int y, double gate,
                    bool colors)
{
  if (!(static_cast<double>(std::abs(a.depth.at<float>(y, x) - b.depth.at<float>(y, x))) <= gate)) return false;
  bool is_alike = true;
  for (int i = 0; i < 3 && colors; ++i)  // a quarter of their range
    is_alike = is_alike && std::abs(a.bgr.at<cv::Vec3b>(y, x)[i] - b.bgr.at<cv::Vec3b>(y, x)[i]) <= 64;
  return is_alike;
}

/// The share of what is seen of an object in either of two poses, of the pixels that nothing in the scene hides, that
/// differs in its surface by more than `tau` (m) or in its color: 0 if nobody can tell the poses apart, 1 also for a
/// pose that is none. `scene` are the exact depths (CV_32FC1, m) of the camera K's image.
/// Source: after the visible surface discrepancy of Hodan, Michel, Brachmann, Kehl, Buch, Kraft, Drost et al.: BOP:
/// Benchmark for 6D Object Pose Estimation, ECCV 2018; colors are not in that.
inline double visibleDiscrepancy(const Object& object, const cv::Affine3d& found, const cv::Affine3d& truth,
                                 const cv::Matx33d& K, const cv::Mat& scene, double tau)
{
  constexpr float kDelta = 0.015F;     // m, by which a surface may be behind what is seen there
  constexpr double kFarthest = 100.0;  // m
  if (!(cv::norm(found.matrix) < kFarthest)) return 1.0;
  robot_vision::MeshView first, second;
  robot_vision::RenderParts parts;
  parts.bgr = true;
  object.shape->renderer().render(K, found, {{0, 0}, scene.size()}, first, parts);
  object.shape->renderer().render(K, truth, {{0, 0}, scene.size()}, second, parts);
  int all = 0, alike = 0;
  for (int y = 0; y < scene.rows; ++y)
    for (int x = 0; x < scene.cols; ++x)
    {
      const float p = first.depth.at<float>(y, x), q = second.depth.at<float>(y, x), seen = scene.at<float>(y, x);
      const auto isVisible = [&](float depth) { return depth > 0.0F && !(depth > seen + kDelta); };
      // Where the object is seen, it would be seen in the other pose, too.
      const bool in_second = isVisible(q), in_first = isVisible(p) || (p > 0.0F && in_second);
      all += in_first || in_second ? 1 : 0;
      alike += in_first && in_second && isAlike(first, second, x, y, tau, true) ? 1 : 0;
    }
  return all > 0 ? 1.0 - static_cast<double>(alike) / all : 1.0;
}

/// How alike an object looks in two poses: the share of the pixels of either one where the depths are at most `gate`
/// (m) apart and, if they count, the colors a quarter of their range.
inline double likeness(const Object& object, const cv::Affine3d& a, const cv::Affine3d& b, const cv::Matx33d& K,
                       const cv::Size& image, double gate, bool colors)
{
  robot_vision::MeshView first, second;
  robot_vision::RenderParts parts;
  parts.bgr = colors;
  object.shape->renderer().render(K, a, {{0, 0}, image}, first, parts);
  object.shape->renderer().render(K, b, {{0, 0}, image}, second, parts);
  int all = 0, alike = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
    {
      if (!(first.depth.at<float>(y, x) > 0.0F) && !(second.depth.at<float>(y, x) > 0.0F)) continue;
      ++all;
      alike += isAlike(first, second, x, y, gate, colors) ? 1 : 0;
    }
  return all > 0 ? static_cast<double>(alike) / all : 0.0;
}

/// The difference of two poses, as far as it can be seen: the distance of the object's middle (m), and an angle (rad).
inline cv::Vec2d visibleError(const Object& object, const cv::Affine3d& found, const cv::Affine3d& truth)
{
  const cv::Vec3d center = object.shape->extent().center;
  const robot_vision::SymmetryGroup symmetries(object.symmetries);
  return {cv::norm(found * center - truth * center), symmetries.angle(found.rotation(), truth.rotation())};
}

}  // namespace trials
