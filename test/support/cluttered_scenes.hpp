#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <opencv2/core/affine.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/scene/depth_noise.hpp"

/// What a frame of ClutteredScenes is to have.
struct ClutterParams
{
  int clutter = 8;         // things beside the object
  double occlusion = 0.0;  // share of the object's pixels that something hides, within 0.05
  bool with_object = true;
  robot_vision::DepthSensor sensor = robot_vision::DepthSensor::kKinect;
  double min_distance = 0.7, max_distance = 1.2;  // m, of the object
  double image_noise = 3.0;                       // gray levels, standard deviation
};

/// A frame with an object on a table among other things, and where it is.
struct ClutteredFrame
{
  robot_vision::CameraModel camera;
  cv::Mat bgr, depth, exact_depth, ids;  // ids: 1: table and wall, 2: the object, 3 and more: other things
  cv::Affine3d pose;                     // of the object in the camera's optical frame
  cv::Affine3d table;                    // the pose of the table's middle there, z up
  double visible = 0.0;                  // share of its pixels that are seen
};

/// A camera as a Kinect's.
inline robot_vision::CameraModel kinectCamera(int width = 640)
{
  const double f = 525.0 * width / 640.0;
  const int height = width * 3 / 4;
  return {width, height, {f, 0, 0.5 * width - 0.5, 0, f, 0.5 * height - 0.5, 0, 0, 1}, {}, "plumb_bob"};
}

/// Frames of an object in any pose on a table, with other meshes around it, in front of textured surfaces, in light
/// from anywhere above. The same for the same seed, number and parameters.
class ClutteredScenes
{
public:
  using Mesh = robot_vision::Mesh;
  using MeshRenderer = robot_vision::MeshRenderer;

  ClutteredScenes(const Mesh& object, const std::vector<Mesh>& others, std::uint64_t seed,
                  const robot_vision::CameraModel& camera = kinectCamera())
    : seed_(seed), camera_(camera), mesh_camera_(camera), object_(object)
  {
    for (const Mesh& other : others)
      others_.push_back(std::make_unique<MeshRenderer>(other));
    cv::RNG random(seed);
    for (int i = 0; i < kRooms; ++i)
      rooms_.push_back(std::make_unique<MeshRenderer>(room(random)));
  }

  ClutteredFrame frame(int number, const ClutterParams& params = ClutterParams()) const
  {
    cv::RNG random(seed_ * 7919 + static_cast<std::uint64_t>(number) * 104729 + 1);
    for (int i = 0; i < 8; ++i)
      random.next();
    ClutteredFrame frame;
    frame.camera = camera_;
    View view;
    do
    {
      view = emptyView(random, params);
      placeObject(random, params, view);
    } while (params.with_object && !isWithinImage(view));
    for (int i = 0; i < params.clutter; ++i)
      placeBeside(random, view);
    if (params.with_object && params.occlusion > 0.0) placeOccluder(random, params.occlusion, view);
    draw(random, number, params, view, frame);
    frame.table = view.world;
    return frame;
  }

private:
  static constexpr int kRooms = 4;
  static constexpr int kAttempts = 20;

  struct Thing
  {
    const MeshRenderer* mesh = nullptr;
    cv::Affine3d pose;
  };

  /// The camera's pose by the table: z of the world is up, its origin is where the camera looks on the table.
  struct View
  {
    cv::Affine3d world;                               // in the camera's optical frame
    std::vector<Thing> things;                        // the room, the object, the others
    std::vector<std::pair<cv::Vec2d, double>> taken;  // places on the table, m
    cv::Vec3d to_light;
  };

  /// A pattern with edges at all scales.
  static cv::Mat texture(cv::RNG& random)
  {
    cv::Mat sum(512, 512, CV_8UC3,
                cv::Scalar(random.uniform(60, 200), random.uniform(60, 200), random.uniform(60, 200)));
    for (int side = 8; side <= 128; side *= 4)
    {
      cv::Mat noise(side, side, CV_8UC3), large;
      random.fill(noise, cv::RNG::UNIFORM, 0, 60);
      cv::resize(noise, large, sum.size(), 0, 0, cv::INTER_CUBIC);
      sum += large - cv::Scalar::all(30);
    }
    for (int i = 0; i < 40; ++i)
    {
      const auto any = [&] { return cv::Point(random.uniform(0, 512), random.uniform(0, 512)); };
      const cv::Scalar color(random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255));
      if (i % 2 == 0)
        cv::line(sum, any(), any(), color, random.uniform(1, 8), cv::LINE_AA);
      else
        cv::ellipse(sum, any(), {random.uniform(4, 40), random.uniform(4, 40)}, random.uniform(0, 180), 0, 360, color,
                    random.uniform(-1, 6) < 0 ? cv::FILLED : 3, cv::LINE_AA);
    }
    return sum;
  }

  /// A table of 1.6 x 1.2 m whose surface is z = 0, and walls and a floor far around it.
  static Mesh room(cv::RNG& random)
  {
    Mesh mesh;
    mesh.textures = {texture(random), texture(random)};
    const auto rectangle = [&](const cv::Vec3f& corner, const cv::Vec3f& right, const cv::Vec3f& up, int texture)
    {
      const int first = static_cast<int>(mesh.vertices.size());
      for (const cv::Vec3f& vertex : {corner, corner + right, corner + right + up, corner + up})
        mesh.vertices.push_back(vertex);
      const float repeat = 1.0F;
      for (const cv::Vec2f& uv :
           {cv::Vec2f(0, repeat), cv::Vec2f(repeat, repeat), cv::Vec2f(repeat, 0), cv::Vec2f(0, 0)})
        mesh.texture_coordinates.push_back(uv);
      mesh.triangles.push_back({first, first + 1, first + 2});
      mesh.triangles.push_back({first, first + 2, first + 3});
      mesh.triangle_textures.insert(mesh.triangle_textures.end(), 2, texture);
    };
    rectangle({-0.8F, -0.6F, 0}, {1.6F, 0, 0}, {0, 1.2F, 0}, 0);
    rectangle({-3, 1.2F, -1}, {6, 0, 0}, {0, 0, 4}, 1);
    rectangle({-3, -4, -0.7F}, {6, 0, 0}, {0, 6, 0}, 1);
    return mesh;
  }

  static cv::Matx33d anyRotation(cv::RNG& random)
  {
    cv::Vec4d q(random.gaussian(1), random.gaussian(1), random.gaussian(1), random.gaussian(1));
    q /= cv::norm(q);
    const double angle = 2.0 * std::acos(std::clamp(q[0], -1.0, 1.0));
    const cv::Vec3d axis(q[1], q[2], q[3]);
    return cv::Affine3d(cv::norm(axis) > 1e-9 ? axis * (angle / cv::norm(axis)) : cv::Vec3d(), cv::Vec3d()).rotation();
  }

  View emptyView(cv::RNG& random, const ClutterParams& params) const
  {
    View view;
    const double pitch = random.uniform(0.4, 0.95), yaw = random.uniform(-0.3, 0.3);
    const double distance = random.uniform(params.min_distance, params.max_distance);
    const cv::Vec3d forward(std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch), -std::sin(pitch));
    const cv::Vec3d right(std::cos(yaw), -std::sin(yaw), 0), down = forward.cross(right);
    const cv::Matx33d rotation(right[0], right[1], right[2], down[0], down[1], down[2], forward[0], forward[1],
                               forward[2]);
    view.world = cv::Affine3d(rotation, cv::Vec3d(random.uniform(-0.12, 0.12), random.uniform(-0.08, 0.08), distance));
    view.things.push_back({rooms_[static_cast<std::size_t>(random.uniform(0, kRooms))].get(), view.world});
    view.to_light = rotation * cv::normalize(cv::Vec3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 0.3), 1.0));
    return view;
  }

  /// In any pose in which it touches the table, at a place on it.
  Thing onTable(cv::RNG& random, const MeshRenderer& mesh, const cv::Vec2d& place, const View& view) const
  {
    const cv::Matx33d rotation = random.uniform(0, 3) == 0
                                     ? cv::Affine3d(cv::Vec3d(0, 0, random.uniform(0.0, 6.28)), cv::Vec3d()).rotation()
                                     : anyRotation(random);
    const robot_vision::MeshExtent& extent = mesh.extent();
    const cv::Vec3d half = 0.5 * extent.size;
    double low = 0.0;  // of the box around it, which is low enough for the table to be touched or nearly so
    for (int i = 0; i < 3; ++i)
      low -= std::abs(rotation(2, i)) * half[i];
    const cv::Vec3d at(place[0], place[1], -low * 0.85);
    return {&mesh, view.world * cv::Affine3d(rotation, at - rotation * extent.center)};
  }

  void placeObject(cv::RNG& random, const ClutterParams& params, View& view) const
  {
    const Thing thing = onTable(random, object_, {0, 0}, view);
    view.taken.emplace_back(cv::Vec2d(), object_.extent().radius);
    if (params.with_object) view.things.push_back(thing);
  }

  bool isWithinImage(const View& view) const
  {
    robot_vision::MeshView alone;
    const cv::Rect image(0, 0, camera_.width, camera_.height);
    object_.render(mesh_camera_, view.things[1].pose, image, alone);
    const cv::Rect box = cv::boundingRect(alone.depth == alone.depth);
    return box.x > 4 && box.y > 4 && box.br().x < image.width - 4 && box.br().y < image.height - 4;
  }

  void placeBeside(cv::RNG& random, View& view) const
  {
    for (int attempt = 0; attempt < 50; ++attempt)
    {
      const MeshRenderer& mesh = anyOther(random);
      const double radius = 0.8 * mesh.extent().radius;
      const cv::Vec2d place(random.uniform(-0.45, 0.45), random.uniform(-0.2, 0.5));
      const Thing thing = onTable(random, mesh, place, view);
      const bool hit =
          std::any_of(view.taken.begin(), view.taken.end(),
                      [&](const auto& other) { return cv::norm(other.first - place) < other.second + radius; });
      if (hit || hides(thing, view)) continue;
      view.taken.emplace_back(place, radius);
      view.things.push_back(thing);
      return;
    }
  }

  /// Whether something may be in front of the object.
  bool hides(const Thing& thing, const View& view) const
  {
    if (view.things.size() < 2) return false;
    const auto middle = [](const Thing& one) { return one.pose * cv::Point3d(one.mesh->extent().center); };
    const cv::Point3d a = middle(view.things[1]), b = middle(thing);
    const double gap = cv::norm(cv::Point2d(a.x / a.z - b.x / b.z, a.y / a.z - b.y / b.z));
    return b.z < a.z && gap < object_.extent().radius / a.z + thing.mesh->extent().radius / b.z;
  }

  /// Has something stand in front of it, pushed aside until it hides as much as it is to hide; or, as nothing hides so
  /// much from where the camera is, something in the air.
  void placeOccluder(cv::RNG& random, double occlusion, View& view) const
  {
    const cv::Vec3d camera = cv::Vec3d(view.world.inv().translation());
    const cv::Vec2d toward = cv::normalize(cv::Vec2d(camera[0], camera[1]));
    view.things.emplace_back();
    for (int attempt = 0; attempt < kAttempts; ++attempt)
    {
      const MeshRenderer& mesh = anyOther(random);
      const double reach = object_.extent().radius + mesh.extent().radius;
      const cv::Vec2d side = cv::Vec2d(-toward[1], toward[0]) * (random.uniform(0, 2) * 2 - 1);
      const Thing thing = onTable(random, mesh, 0.75 * reach * toward, view);
      const cv::Vec3d aside = view.world.rotation() * cv::Vec3d(side[0], side[1], 0.0);
      if (pushAside(thing, aside, reach, occlusion, view)) return;
    }
    const MeshRenderer& mesh = anyOther(random);
    const cv::Vec3d middle = cv::Vec3d(view.things[1].pose * cv::Point3d(object_.extent().center));
    const double reach = object_.extent().radius + mesh.extent().radius, from = random.uniform(0.0, 6.28);
    const cv::Vec3d ahead = middle * (1.0 - (reach + 0.02) / cv::norm(middle));
    const cv::Matx33d rotation = anyRotation(random);
    pushAside({&mesh, cv::Affine3d(rotation, ahead - rotation * mesh.extent().center)},
              {std::cos(from), std::sin(from), 0.0}, reach, occlusion, view);
  }

  const MeshRenderer& anyOther(cv::RNG& random) const
  {
    return *others_[static_cast<std::size_t>(random.uniform(0, static_cast<int>(others_.size())))];
  }

  /// Puts a thing at the end of the view's, by what share of `reach` aside it has to be; false: it hides too little.
  bool pushAside(const Thing& thing, const cv::Vec3d& aside, double reach, double occlusion, View& view) const
  {
    double near = 0.0, far = reach, hidden = 0.0;
    for (int i = 0; i < 10; ++i)
    {
      const double at = i == 0 ? 0.0 : 0.5 * (near + far);
      view.things.back() = {thing.mesh, cv::Affine3d(thing.pose.rotation(), thing.pose.translation() + at * aside)};
      hidden = 1.0 - visibleShare(view);
      if (i == 0 && hidden < occlusion) return false;
      (hidden > occlusion ? near : far) = at;
    }
    return std::abs(hidden - occlusion) < 0.05;
  }

  double visibleShare(const View& view) const
  {
    const cv::Rect image(0, 0, camera_.width, camera_.height);
    robot_vision::MeshView alone, all;
    robot_vision::RenderParts parts;
    parts.ids = true;
    object_.render(mesh_camera_, view.things[1].pose, image, alone, parts);
    object_.render(mesh_camera_, view.things[1].pose, image, all, parts);
    for (std::size_t i = 2; i < view.things.size(); ++i)
      view.things[i].mesh->merge(mesh_camera_, view.things[i].pose, image, all, parts, static_cast<int>(i));
    const int count = cv::countNonZero(alone.ids);
    return count == 0 ? 0.0 : cv::countNonZero(all.ids == 1) / static_cast<double>(count);
  }

  void draw(cv::RNG& random, int number, const ClutterParams& params, const View& view, ClutteredFrame& frame) const
  {
    const cv::Rect image(0, 0, camera_.width, camera_.height);
    robot_vision::MeshView drawn;
    robot_vision::RenderParts parts;
    parts.bgr = parts.ids = true;
    parts.to_light = view.to_light;
    view.things[0].mesh->render(mesh_camera_, view.things[0].pose, image, drawn, parts);
    const std::size_t first_other = params.with_object ? 1 : 2;  // the object's id is always 2
    for (std::size_t i = 1; i < view.things.size(); ++i)
      view.things[i].mesh->merge(mesh_camera_, view.things[i].pose, image, drawn, parts,
                                 static_cast<int>(i + first_other - 1));
    cv::Mat noise(drawn.bgr.size(), CV_16SC3), sum;
    random.fill(noise, cv::RNG::NORMAL, 0.0, params.image_noise);
    cv::add(drawn.bgr, noise, frame.bgr, cv::noArray(), CV_8UC3);
    cv::cvtColor(drawn.bgr, sum, cv::COLOR_BGR2GRAY);
    frame.exact_depth = drawn.depth;
    frame.ids = drawn.ids;
    robot_vision::DepthNoise(params.sensor, camera_, seed_).apply(number, drawn.depth, sum, frame.depth);
    if (!params.with_object) return;
    frame.pose = view.things[1].pose;
    frame.visible = visibleShare(view);
  }

  std::uint64_t seed_;
  robot_vision::CameraModel camera_;
  robot_vision::MeshCamera mesh_camera_;
  MeshRenderer object_;
  std::vector<std::unique_ptr<MeshRenderer>> others_, rooms_;
};
