#include "robot_vision/meshes/sample_meshes.hpp"

#include "robot_vision/common/range.hpp"
#include "sample_meshes.hpp"

namespace robot_vision
{
namespace
{

struct Sample
{
  Mesh (*make)();
  std::vector<SampleSymmetry> symmetries;
};

const std::vector<std::pair<std::string, Sample>>& allSamples()
{
  static const SampleSymmetry round{{0, 0, 1}, 0}, sixfold{{0, 0, 1}, 6}, turned_over{{1, 0, 0}, 2};
  static const std::vector<std::pair<std::string, Sample>> all = {
      {"bottle", {samples::bottle, {round}}},
      {"box", {samples::box, {}}},
      {"bracket", {samples::bracket, {}}},
      {"can", {samples::can, {round}}},
      {"drill", {samples::drill, {}}},
      {"duck", {samples::duck, {}}},
      {"mug", {samples::mug, {}}},
      {"nut", {samples::nut, {sixfold, turned_over}}},
  };
  return all;
}

}  // namespace

const std::vector<std::string>& sampleMeshNames()
{
  static const std::vector<std::string> names = []
  {
    std::vector<std::string> list;
    for (const auto& sample : allSamples())
      list.push_back(sample.first);
    return list;
  }();
  return names;
}

SampleMesh sampleMesh(const std::string& name)
{
  for (const auto& sample : allSamples())
    if (sample.first == name) return {name, sample.second.make(), sample.second.symmetries};
  require(false, "sample mesh", "'" + name + "'", "one of " + joined(sampleMeshNames()));
  return {};
}

}  // namespace robot_vision
