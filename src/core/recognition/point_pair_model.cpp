#include <cmath>
#include <string>
#include <utility>

#include "robot_vision/common/range.hpp"
#include "robot_vision/recognition/point_pairs.hpp"
#include "surface_sampling.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMinPoints = 10, kMaxPoints = 5000;  // whose pairs are in memory
constexpr double kMaxExtent = 2000.0;                      // m

}  // namespace

PointPairModel trainPointPairs(const Mesh& mesh, const PointPairParams& params)
{
  validate(params);
  PointPairModel model;
  model.params = params;
  model.extent = meshExtent(mesh);
  require(model.extent.diameter > 0.0, "the diameter of the mesh", model.extent.diameter, "above 0");
  OrientedPoints sampled = sampleSurface(mesh, params.sampling * model.extent.diameter);
  model.points = std::move(sampled.points);
  model.normals = std::move(sampled.normals);
  validate(model);
  return model;
}

void validate(const PointPairModel& model)
{
  validate(model.params);
  requireRange("the diameter of the model", model.extent.diameter, 1e-6, kMaxExtent);
  requireRange("the radius of the model", model.extent.radius, 0.0, model.extent.diameter);
  for (int i = 0; i < 3; ++i)
  {
    requireRange("the center of the model", model.extent.center[i], -kMaxExtent, kMaxExtent);
    requireRange("the size of the model", model.extent.size[i], 0.0, kMaxExtent);
  }
  const std::size_t count = model.points.size();
  require(count >= kMinPoints && count <= kMaxPoints, "the number of points of the model", static_cast<double>(count),
          "from " + std::to_string(kMinPoints) + " to " + std::to_string(kMaxPoints) + ", as another sampling than " +
              toText(model.params.sampling) + " gives");
  require(model.normals.size() == count, "the number of normals of the model",
          static_cast<double>(model.normals.size()), "that of its points, " + std::to_string(count));
  for (std::size_t i = 0; i < count; ++i)
  {
    const double distance = cv::norm(cv::Vec3d(model.points[i]) - model.extent.center);
    requireRange("the distance of a point from the center of the model", distance, 0.0, 1.01 * model.extent.radius);
    requireRange("the length of a normal of the model", cv::norm(model.normals[i]), 0.999, 1.001);
  }
}

}  // namespace robot_vision
