#include "scene_meshes.hpp"

#include <algorithm>
#include <cctype>
#include <exception>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "robot_vision/camera/frame_source.hpp"
#include "robot_vision/meshes/mesh_reader.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"

namespace robot_vision
{
namespace
{

std::string trimmed(const std::string& text)
{
  const std::size_t begin = text.find_first_not_of(" \t"), end = text.find_last_not_of(" \t");
  return begin == std::string::npos ? "" : text.substr(begin, end - begin + 1);
}

std::string frameName(const std::string& file, const std::set<std::string>& taken)
{
  std::string name = std::filesystem::path(file).stem();
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  std::string free = name;
  for (int number = 2; taken.count(free) > 0; ++number)
    free = name + "_" + std::to_string(number);
  return free;
}

Mesh readOne(const std::string& one, std::string& remarks)
{
  const std::vector<std::string>& samples = sampleMeshNames();
  if (std::find(samples.begin(), samples.end(), one) != samples.end()) return sampleMesh(one).mesh;
  LoadedMesh loaded = readMesh(one);
  loaded.warnings.insert(loaded.warnings.begin(), loaded.unit_reason);
  for (const std::string& sentence : loaded.warnings)
    remarks += (remarks.empty() ? "" : "; ") + one + ": " + sentence;
  return std::move(loaded.mesh);
}

}  // namespace

SceneMeshes readSceneMeshes(const std::string& list)
try
{
  SceneMeshes result;
  if (trimmed(list).empty()) return {sampleTabletop(), ""};
  std::set<std::string> names;
  std::map<std::string, Mesh> read;  // what is named again is the same
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');)
  {
    const std::string one = trimmed(word);
    if (one.empty()) throw std::invalid_argument("there is nothing between two commas");
    const std::string name = frameName(one, names);
    names.insert(name);
    if (read.count(one) == 0) read[one] = readOne(one, result.remarks);
    result.meshes.push_back({name, read.at(one)});
  }
  return result;
}
catch (const std::exception& e)
{
  throw SourceError(std::string("meshes: ") + e.what());
}

}  // namespace robot_vision
