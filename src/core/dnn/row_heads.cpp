#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "best_class.hpp"
#include "heads.hpp"

namespace robot_vision
{
namespace
{

constexpr std::int64_t kAny = HeadOutputs::kAny;
constexpr std::size_t kFirstNanodetGrids = 3;  // of the first version; NanoDet-Plus has four

/// The cells of the grids of a network, one grid after the other, each row by row.
class GridCells
{
public:
  /// `partial`: whether cells that the input does not fill count.
  GridCells(const HeadParams& params, const std::vector<int>& usual, bool partial)
  {
    for (const int stride : params.strides.empty() ? usual : params.strides)
    {
      const int rest = partial ? stride - 1 : 0;
      const int columns = (params.input_width + rest) / stride, rows = (params.input_height + rest) / stride;
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
          cells.push_back({x, y, stride});
    }
  }

  struct Cell
  {
    int x, y, stride;
  };

  std::vector<Cell> cells;
};

/// The numbers 0, 1, ... weighted by the softmax of `bins` logits.
double expectedBin(const float* logits, int bins)
{
  const float highest = *std::max_element(logits, logits + bins);
  double sum = 0.0, weighted = 0.0;
  for (int i = 0; i < bins; ++i)
  {
    const double weight = std::exp(static_cast<double>(logits[i]) - highest);
    sum += weight;
    weighted += weight * i;
  }
  return weighted / sum;
}

/// Calls found(row, values of the row, class, score) for rows with an objectness and class scores behind four numbers.
template <class Found>
void forRows(const OutputRows& rows, int classes, const Candidates& candidates, const Found& found)
{
  const ScoreKernels& kernel = kernels<ScoreKernels>();
  for (std::size_t i = 0; i < rows.rows; ++i)
  {
    const float* const row = rows.row(i);
    if (!(row[4] >= candidates.lowest() && std::isfinite(row[4]))) continue;
    const BestClass best = bestClass(kernel, row + 5, classes, candidates.lowestRank());
    if (best.class_id >= 0) found(i, row, best.class_id, best.score);
  }
}

}  // namespace

void findYolov3(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  if (outputs.count() == 0) outputs.requireCount(1);
  std::size_t before = 0;
  for (std::size_t i = 0; i < outputs.count(); ++i)
  {
    const OutputRows rows = outputs.rows(i, {kAny, 5 + params.classes});
    const auto add = [&](std::size_t index, const float* row, int class_id, float score)
    {
      if (!candidates.reaches(score, class_id)) return;
      const double width = params.input_width, height = params.input_height;
      candidates.addCentered(score, class_id, before + index, row[0] * width, row[1] * height, row[2] * width,
                             row[3] * height);
    };
    forRows(rows, params.classes, candidates, add);
    before += rows.rows;
  }
}

void findYolov5(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  const std::size_t known = 5 + static_cast<std::size_t>(params.classes);
  const bool segments = params.task == "segment";
  outputs.requireCount(segments ? 2 : 1);
  const std::size_t more = segments ? outputs.rows(1, {kAny, kAny, kAny}).rows : 0;
  const OutputRows rows = outputs.rows(0, {kAny, static_cast<std::int64_t>(known + more)});
  candidates.extras = {rows.values + known, rows.columns, 1, more};
  const auto add = [&](std::size_t index, const float* row, int class_id, float class_score)
  {
    const float score = row[4] * class_score;
    if (candidates.reaches(score, class_id))
      candidates.addCentered(score, class_id, index, row[0], row[1], row[2], row[3]);
  };
  forRows(rows, params.classes, candidates, add);
}

void findYolox(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  outputs.requireCount(1);
  const GridCells grid(params, {8, 16, 32}, false);
  const OutputRows rows = outputs.rows(0, {static_cast<std::int64_t>(grid.cells.size()), 5 + params.classes});
  const auto add = [&](std::size_t index, const float* row, int class_id, float class_score)
  {
    const float score = row[4] * class_score;
    if (!candidates.reaches(score, class_id)) return;
    const GridCells::Cell& cell = grid.cells[index];
    const double stride = cell.stride;
    candidates.addCentered(score, class_id, index, (row[0] + static_cast<double>(cell.x)) * stride,
                           (row[1] + static_cast<double>(cell.y)) * stride,
                           std::exp(static_cast<double>(row[2])) * stride,
                           std::exp(static_cast<double>(row[3])) * stride);
  };
  forRows(rows, params.classes, candidates, add);
}

void findNanodet(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  outputs.requireCount(1);
  const ScoreKernels& kernel = kernels<ScoreKernels>();
  const GridCells grid(params, {8, 16, 32, 64}, true);
  const double shift = params.strides.size() == kFirstNanodetGrids ? 0.5 : 0.0;
  const int bins = params.reg_max + 1;
  const OutputRows rows = outputs.rows(0, {static_cast<std::int64_t>(grid.cells.size()), params.classes + 4 * bins});
  for (std::size_t i = 0; i < rows.rows; ++i)
  {
    const float* const row = rows.row(i);
    const BestClass best = bestClass(kernel, row, params.classes, candidates.lowestRank());
    if (best.class_id < 0 || !candidates.reaches(best.score, best.class_id)) continue;
    const GridCells::Cell& cell = grid.cells[i];
    std::array<double, 4> distances;  // left, top, right, bottom
    for (std::size_t side = 0; side < 4; ++side)
      distances[side] =
          expectedBin(row + params.classes + static_cast<std::ptrdiff_t>(side) * bins, bins) * cell.stride;
    const double x = (cell.x + shift) * cell.stride, y = (cell.y + shift) * cell.stride;
    const auto inside = [](double at, int end) { return std::min(std::max(at, 0.0), static_cast<double>(end)); };
    candidates.add(best.score, best.class_id, i,
                   {inside(x - distances[0], params.input_width), inside(y - distances[1], params.input_height),
                    inside(x + distances[2], params.input_width), inside(y + distances[3], params.input_height)});
  }
}

}  // namespace robot_vision
