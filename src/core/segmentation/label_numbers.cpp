#include "label_numbers.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace robot_vision
{
namespace
{

constexpr double kMinOverlap = 0.5;  // of a segment and the earlier one, of the smaller area

/// The number of pixels of each label.
std::vector<int> countPixels(const cv::Mat_<int>& labels)
{
  std::vector<int> areas(1);
  for (const int label : labels)
  {
    if (label >= static_cast<int>(areas.size())) areas.resize(label + 1);
    ++areas[label];
  }
  return areas;
}

/// The labels that are kept, the largest first, of equal ones the smaller label.
std::vector<int> chooseLabels(const std::vector<int>& areas, const NumberingRule& rule)
{
  std::vector<int> order(areas.size() - 1);
  std::iota(order.begin(), order.end(), 1);
  const auto is_small = [&](int label) { return areas[label] == 0 || areas[label] < rule.min_area; };
  order.erase(std::remove_if(order.begin(), order.end(), is_small), order.end());
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return areas[a] > areas[b]; });
  order.resize(std::min(order.size(), static_cast<std::size_t>(rule.max_segments)));
  return order;
}

}  // namespace

cv::Mat LabelNumbers::apply(const cv::Mat& labels, const NumberingRule& rule)
{
  const std::vector<int> areas = countPixels(labels);
  const std::vector<int> order = chooseLabels(areas, rule);
  std::vector<int> numbers = order;
  if (rule.by_size && rule.keep && last_.size() == labels.size())
    numbers = keptNumbers(labels, areas, order);
  else if (rule.by_size)
    std::iota(numbers.begin(), numbers.end(), 1);
  std::vector<std::uint16_t> table(areas.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    table[order[i]] = static_cast<std::uint16_t>(numbers[i]);
  cv::Mat_<std::uint16_t> numbered(labels.size());
  std::transform(labels.begin<int>(), labels.end<int>(), numbered.begin(), [&](int label) { return table[label]; });
  last_ = numbered;
  return numbered;
}

std::vector<int> LabelNumbers::keptNumbers(const cv::Mat& labels, const std::vector<int>& areas,
                                           const std::vector<int>& order)
{
  double highest = 0.0;
  cv::minMaxLoc(last_, nullptr, &highest);
  const int count = static_cast<int>(order.size());
  std::vector<int> places(areas.size(), -1), earlier_areas(static_cast<int>(highest) + 1);
  for (int i = 0; i < count; ++i)
    places[order[i]] = i;
  cv::Mat_<int> common = cv::Mat::zeros(count, static_cast<int>(highest) + 1, CV_32SC1);
  auto before = last_.begin<std::uint16_t>();
  for (auto label = labels.begin<int>(); label != labels.end<int>(); ++label, ++before)
  {
    ++earlier_areas[*before];
    if (places[*label] >= 0) ++common(places[*label], *before);
  }
  // The larger segments choose first; what has no number then gets the lowest that is free.
  std::vector<int> numbers(count);
  std::vector<bool> taken(std::max(count, static_cast<int>(highest)) + 2);
  taken[0] = true;
  for (int i = 0; i < count; ++i)
  {
    const int* shared = common[i];
    const auto best = static_cast<int>(std::max_element(shared + 1, shared + common.cols) - shared);
    if (common.cols < 2 || taken[best]) continue;
    if (shared[best] <= kMinOverlap * std::min(areas[order[i]], earlier_areas[best])) continue;
    numbers[i] = best;
    taken[best] = true;
  }
  auto free = taken.begin();
  for (int& number : numbers)
  {
    if (number > 0) continue;
    free = std::find(free, taken.end(), false);
    number = static_cast<int>(free - taken.begin());
    *free = true;
  }
  return numbers;
}

}  // namespace robot_vision
