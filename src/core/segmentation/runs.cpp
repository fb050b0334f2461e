#include "runs.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace robot_vision
{
namespace
{

/// Skips black pixels in [begin, end) in blocks of 8 * kEights. Returns the first block that has a white pixel, or else
/// the remainder that is shorter than a block.
template <std::size_t kEights>
const std::uint8_t* skipBlack(const std::uint8_t* begin, const std::uint8_t* end)
{
  std::array<std::uint64_t, kEights> eights;
  for (; end - begin >= static_cast<std::ptrdiff_t>(sizeof eights); begin += sizeof eights)
  {
    std::memcpy(eights.data(), begin, sizeof eights);
    std::uint64_t any = 0;
    for (const std::uint64_t eight : eights)
      any |= eight;
    if (any != 0) break;
  }
  return begin;
}

/// The first white pixel in [begin, end), or end.
const std::uint8_t* findWhite(const std::uint8_t* begin, const std::uint8_t* end)
{
  begin = skipBlack<1>(skipBlack<8>(begin, end), end);  // most of a mask is black
  return std::find_if(begin, end, [](std::uint8_t pixel) { return pixel != 0; });
}

void appendRow(const cv::Mat& mask, int y, const cv::Range& columns, std::vector<Run>& runs)
{
  const std::uint8_t* const row = mask.ptr(y);
  const std::uint8_t* const row_end = row + columns.end;
  for (const std::uint8_t* begin = findWhite(row + columns.start, row_end); begin != row_end;)
  {
    const void* const black = std::memchr(begin, 0, static_cast<std::size_t>(row_end - begin));
    const std::uint8_t* const end = black ? static_cast<const std::uint8_t*>(black) : row_end;
    runs.push_back({y, static_cast<int>(begin - row), static_cast<int>(end - row), static_cast<int>(runs.size())});
    begin = findWhite(end, row_end);
  }
}

/// The first run of the region that a run belongs to: the root of a union-find tree.
int findFirst(std::vector<Run>& runs, int index)
{
  while (runs[index].first != index)
    index = runs[index].first = runs[runs[index].first].first;
  return index;
}

void join(std::vector<Run>& runs, int a, int b)
{
  a = findFirst(runs, a);
  b = findFirst(runs, b);
  runs[std::max(a, b)].first = std::min(a, b);
}

/// Joins the runs from index `row` on with those of the row before, which begin at index `above`.
void joinRows(std::vector<Run>& runs, int above, int row)
{
  for (int below = row; below < static_cast<int>(runs.size()); ++below)
  {
    while (above < row && runs[above].end < runs[below].begin)
      ++above;
    for (int touching = above; touching < row && runs[touching].begin <= runs[below].end; ++touching)
      join(runs, touching, below);
  }
}

}  // namespace

std::vector<Run> findRuns(const cv::Mat& mask, const cv::Rect& part)
{
  std::vector<Run> runs;
  int above = 0;
  for (int y = part.y; y < part.br().y; ++y)
  {
    const int row = static_cast<int>(runs.size());
    appendRow(mask, y, {part.x, part.br().x}, runs);
    joinRows(runs, above, row);
    above = row;
  }
  for (Run& run : runs)
    run.first = runs[run.first].first;
  return runs;
}

const Run& runAt(const std::vector<Run>& runs, const cv::Point& pixel)
{
  const auto is_after = [](const cv::Point& p, const Run& run)
  { return p.y < run.y || (p.y == run.y && p.x < run.begin); };
  return *(std::upper_bound(runs.begin(), runs.end(), pixel, is_after) - 1);
}

}  // namespace robot_vision
