#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <vector>

namespace robot_vision
{

/// Finds descriptors that are nearly the nearest of many: of bits by hash tables, of floats by KD-trees. The same for
/// the same descriptors. For one thread at a time.
class DescriptorIndex
{
public:
  /// CV_8UC1 or CV_32FC1, a row for each descriptor, one at least.
  explicit DescriptorIndex(const cv::Mat& descriptors);

  /// Up to `count` of the nearest rows to each query, a descriptor of the same type and length, the nearest first. What
  /// differs in more than a quarter of its bits may be missing.
  std::vector<std::vector<cv::DMatch>> nearest(const cv::Mat& queries, int count);

private:
  static constexpr int kTables = 8;
  static constexpr int kKeyBits = 14;
  static constexpr int kKeys = 1 << kKeyBits;

  /// Rows by the values of some of their bits.
  struct Table
  {
    std::vector<int> bits;              // indices
    std::vector<std::uint32_t> starts;  // in rows, of each key
    std::vector<std::uint32_t> rows;
  };

  static int keyOf(const Table& table, const std::uint8_t* descriptor);
  void fill(Table& table) const;
  void visit(const Table& table, int key, int query, const std::uint8_t* descriptor, std::size_t count,
             std::vector<cv::DMatch>& found);

  cv::Mat descriptors_;
  std::vector<Table> tables_;
  std::vector<int> seen_by_;  // of each row, the last query that it was compared with
  cv::Ptr<cv::DescriptorMatcher> trees_;
};

}  // namespace robot_vision
