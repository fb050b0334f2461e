#include "haar_cascade.hpp"

#include <cmath>
#include <limits>

namespace robot_vision
{
namespace
{

constexpr float kThresholdMargin = 1e-5F;  // by which OpenCV lowers each stage's threshold
constexpr double kMaxSum = 1 << 24;        // of a feature: up to this, floats are exact
constexpr double kMaxGray = 255.0;         // gray levels
constexpr int kMinWindow = 3;              // px: its contrast is that of what is inside of a border of 1 px
constexpr int kMaxIntegers = 1 << 20;      // in a list of numbers

/// The numbers in a node, none if there are too many or it has something else.
template <class Number>
std::vector<Number> numbersOf(const cv::FileNode& node)
{
  std::vector<Number> numbers;
  if (!node.isSeq() || node.size() > kMaxIntegers) return numbers;
  for (const cv::FileNode& number : node)
  {
    if (!number.isInt() && !number.isReal()) return {};
    numbers.push_back(static_cast<Number>(number));
  }
  return numbers;
}

/// Whether the rectangle is of a kind that is searched for exactly; `sum` becomes larger by what it can add.
bool read(const cv::FileNode& node, const cv::Size& window, HaarRectangle& rectangle, double& sum)
{
  const std::vector<float> numbers = numbersOf<float>(node);
  if (numbers.size() != 5) return false;
  for (const float number : numbers)
    if (number != std::round(number) || std::abs(number) > kMaxSum) return false;
  const auto whole = [&](std::size_t i) { return static_cast<int>(numbers[i]); };
  rectangle.box = {whole(0), whole(1), whole(2), whole(3)};
  rectangle.weight = numbers[4];
  sum += kMaxGray * std::abs(numbers[4]) * rectangle.box.area();
  return !rectangle.box.empty() && (rectangle.box & cv::Rect({}, window)) == rectangle.box;
}

bool read(const cv::FileNode& node, const cv::Size& window, std::array<HaarRectangle, 3>& rectangles)
{
  const cv::FileNode boxes = node["rects"];
  if (static_cast<int>(node["tilted"]) != 0 || !boxes.isSeq() || boxes.size() < 2 || boxes.size() > rectangles.size())
    return false;
  double sum = 0.0;
  std::size_t i = 0;
  for (const cv::FileNode& box : boxes)
    if (!read(box, window, rectangles[i++], sum)) return false;
  return sum < kMaxSum;
}

bool read(const cv::FileNode& node, const std::vector<std::array<HaarRectangle, 3>>& features, HaarStump& stump)
{
  const std::vector<double> branches = numbersOf<double>(node["internalNodes"]);  // left, right, feature, threshold
  const std::vector<float> votes = numbersOf<float>(node["leafValues"]);
  if (branches.size() != 4 || votes.size() != 2 || branches[0] != 0.0 || branches[1] != -1.0) return false;
  if (branches[2] != std::floor(branches[2]) || branches[2] < 0.0 ||
      branches[2] >= static_cast<double>(features.size()))
    return false;
  stump.rectangles = features[static_cast<std::size_t>(branches[2])];
  stump.threshold = static_cast<float>(branches[3]);
  stump.below = votes[0];
  stump.above = votes[1];
  return std::isfinite(stump.threshold) && std::isfinite(stump.below) && std::isfinite(stump.above);
}

bool read(const cv::FileNode& node, const std::vector<std::array<HaarRectangle, 3>>& features, HaarStage& stage)
{
  const cv::FileNode stumps = node["weakClassifiers"];
  if (!stumps.isSeq() || stumps.size() == 0) return false;
  stage.threshold = static_cast<float>(node["stageThreshold"]) - kThresholdMargin;
  for (const cv::FileNode& stump : stumps)
    if (!read(stump, features, stage.stumps.emplace_back())) return false;
  return std::isfinite(stage.threshold);
}

bool read(const cv::FileNode& root, HaarCascade& cascade)
{
  if (!root.isMap() || static_cast<std::string>(root["stageType"]) != "BOOST" ||
      static_cast<std::string>(root["featureType"]) != "HAAR" ||
      static_cast<int>(root["featureParams"]["maxCatCount"]) != 0)
    return false;
  cascade.window = {static_cast<int>(root["width"]), static_cast<int>(root["height"])};
  const double area = static_cast<double>(cascade.window.width) * cascade.window.height;
  if (std::min(cascade.window.width, cascade.window.height) < kMinWindow ||
      kMaxGray * kMaxGray * area > std::numeric_limits<std::int32_t>::max())
    return false;
  const cv::FileNode boxes = root["features"], stages = root["stages"];
  if (!boxes.isSeq() || !stages.isSeq() || stages.size() == 0) return false;
  std::vector<std::array<HaarRectangle, 3>> features;
  for (const cv::FileNode& feature : boxes)
    if (!read(feature, cascade.window, features.emplace_back())) return false;
  for (const cv::FileNode& stage : stages)
    if (!read(stage, features, cascade.stages.emplace_back())) return false;
  return true;
}

}  // namespace

std::shared_ptr<const HaarCascade> readHaarCascade(const std::string& path)
{
  const cv::FileStorage file(path, cv::FileStorage::READ);
  auto cascade = std::make_shared<HaarCascade>();
  if (!file.isOpened() || !read(file.getFirstTopLevelNode(), *cascade)) return nullptr;
  return cascade;
}

}  // namespace robot_vision
