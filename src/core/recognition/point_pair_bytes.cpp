#include "byte_stream.hpp"
#include "model_head.hpp"
#include "robot_vision/recognition/point_pairs.hpp"

namespace robot_vision
{
namespace
{

/// Calls visit(number) for each number of a model, but for its points.
template <class Model, class Visit>
void visitNumbers(Model& model, const Visit& visit)
{
  PointPairParams::fields([&](const char* /*name*/, auto member, const auto& /*limits*/, const char* /*unit*/,
                              const char* /*meaning*/) { visit(model.params.*member); });
  visitExtent(model.extent, visit);
}

}  // namespace

std::vector<std::uint8_t> toBytes(const PointPairModel& model)
{
  validate(model);
  ByteWriter to;
  writeModelHead(PointPairModel::kMethod, to);
  visitNumbers(model, [&](const auto& number) { to.add(number); });
  to.add(static_cast<std::uint32_t>(model.points.size()));
  for (std::size_t i = 0; i < model.points.size(); ++i)
    for (const cv::Vec3f& vector : {model.points[i], model.normals[i]})
      for (int j = 0; j < 3; ++j)
        to.add(vector[j]);
  return to.take();
}

PointPairModel pointPairModelFromBytes(const std::uint8_t* bytes, std::size_t size)
{
  ByteReader from(bytes, size, "a trained model");
  checkModelHead(PointPairModel::kMethod, from);
  PointPairModel model;
  visitNumbers(model, [&](auto& number) { from.get(number); });
  const std::size_t count = from.count<std::uint32_t>("points", 6 * sizeof(float));
  model.points.resize(count);
  model.normals.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    for (cv::Vec3f* vector : {&model.points[i], &model.normals[i]})
      for (int j = 0; j < 3; ++j)
        from.get((*vector)[j]);
  from.end();
  validate(model);
  return model;
}

}  // namespace robot_vision
