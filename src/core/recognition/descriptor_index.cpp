#include "descriptor_index.hpp"

#include <algorithm>
#include <numeric>
#include <opencv2/core/hal/hal.hpp>

#include "core/common/random_state.hpp"
#include "key_bits.hpp"

namespace robot_vision
{
namespace
{

constexpr int kSeed = 0x5EED;
constexpr int kTrees = 5, kChecks = 50;  // of FLANN, as OpenCV's tutorials have them

}  // namespace

DescriptorIndex::DescriptorIndex(const cv::Mat& descriptors)
  : descriptors_(descriptors.clone()), seen_by_(static_cast<std::size_t>(descriptors.rows), -1)
{
  if (descriptors.depth() == CV_32F)
  {
    const RandomState seeded(kSeed);
    trees_ = cv::makePtr<cv::FlannBasedMatcher>(cv::makePtr<cv::flann::KDTreeIndexParams>(kTrees),
                                                cv::makePtr<cv::flann::SearchParams>(kChecks));
    trees_->add(std::vector<cv::Mat>{descriptors_});
    trees_->train();
    return;
  }
  cv::RNG random(kSeed);
  const KeyBits bits(descriptors_);
  tables_.resize(kTables);
  for (Table& table : tables_)
  {
    table.bits = bits.choose(kKeyBits, random);
    fill(table);
  }
}

int DescriptorIndex::keyOf(const Table& table, const std::uint8_t* descriptor)
{
  int key = 0;
  for (const int bit : table.bits)
    key = key << 1 | (descriptor[bit >> 3] >> (bit & 7) & 1);
  return key;
}

void DescriptorIndex::fill(Table& table) const
{
  std::vector<int> keys;
  table.starts.assign(kKeys + 1, 0);
  for (int row = 0; row < descriptors_.rows; ++row)
  {
    keys.push_back(keyOf(table, descriptors_.ptr(row)));
    ++table.starts[static_cast<std::size_t>(keys.back()) + 1];
  }
  std::partial_sum(table.starts.begin(), table.starts.end(), table.starts.begin());
  std::vector<std::uint32_t> next(table.starts.begin(), table.starts.end() - 1);
  table.rows.resize(keys.size());
  for (std::size_t row = 0; row < keys.size(); ++row)
    table.rows[next[static_cast<std::size_t>(keys[row])]++] = static_cast<std::uint32_t>(row);
}

void DescriptorIndex::visit(const Table& table, int key, int query, const std::uint8_t* descriptor, std::size_t count,
                            std::vector<cv::DMatch>& found)
{
  const auto isNearer = [](const cv::DMatch& a, const cv::DMatch& b) { return a.distance < b.distance; };
  const auto begin = table.starts[static_cast<std::size_t>(key)], end = table.starts[static_cast<std::size_t>(key) + 1];
  for (auto i = begin; i < end; ++i)
  {
    const auto row = static_cast<int>(table.rows[i]);
    if (seen_by_[table.rows[i]] == query) continue;
    seen_by_[table.rows[i]] = query;
    const int bits = cv::hal::normHamming(descriptor, descriptors_.ptr(row), descriptors_.cols);
    const cv::DMatch match(query, row, static_cast<float>(bits));
    if (found.size() == count && !isNearer(match, found.back())) continue;
    if (found.size() == count) found.pop_back();
    found.insert(std::upper_bound(found.begin(), found.end(), match, isNearer), match);
  }
}

std::vector<std::vector<cv::DMatch>> DescriptorIndex::nearest(const cv::Mat& queries, int count)
{
  std::vector<std::vector<cv::DMatch>> found(static_cast<std::size_t>(queries.rows));
  if (queries.empty()) return found;
  if (trees_)
  {
    const RandomState seeded(kSeed);
    trees_->knnMatch(queries, found, std::min(count, descriptors_.rows));
    return found;
  }
  std::fill(seen_by_.begin(), seen_by_.end(), -1);
  for (int query = 0; query < queries.rows; ++query)
  {
    const std::uint8_t* const descriptor = queries.ptr(query);
    for (const Table& table : tables_)
    {
      const int key = keyOf(table, descriptor);
      std::vector<cv::DMatch>& nearest_rows = found[static_cast<std::size_t>(query)];
      visit(table, key, query, descriptor, static_cast<std::size_t>(count), nearest_rows);
      for (std::size_t bit = 0; bit < table.bits.size(); ++bit)
        visit(table, key ^ 1 << bit, query, descriptor, static_cast<std::size_t>(count), nearest_rows);
    }
  }
  return found;
}

}  // namespace robot_vision
