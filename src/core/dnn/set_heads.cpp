#include <algorithm>
#include <cmath>
#include <cstddef>

#include "best_class.hpp"
#include "heads.hpp"

namespace robot_vision
{
namespace
{

constexpr std::int64_t kAny = HeadOutputs::kAny;

/// The class that a number names, with `first` as that of class 0; -1 if it is none of them.
int classOf(float number, int first, int classes)
{
  const float class_id = number - static_cast<float>(first);
  const bool is_one = class_id >= 0.0F && class_id < static_cast<float>(classes) && std::floor(class_id) == class_id;
  return is_one ? static_cast<int>(class_id) : -1;
}

/// Adds a box of 0..1 of the input by its corners.
void addShare(const HeadParams& params, float score, int class_id, std::size_t index, const float* corners,
              Candidates& candidates)
{
  const double width = params.input_width, height = params.input_height;
  candidates.add(score, class_id, index,
                 {corners[0] * width, corners[1] * height, corners[2] * width, corners[3] * height});
}

/// Adds a box of 0..1 of the input by its centre and size.
void addCenteredShare(const HeadParams& params, float score, int class_id, std::size_t index, const float* box,
                      Candidates& candidates)
{
  const double width = params.input_width, height = params.input_height;
  candidates.addCentered(score, class_id, index, box[0] * width, box[1] * height, box[2] * width, box[3] * height);
}

}  // namespace

void findYolov10(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  outputs.requireCount(1);
  const OutputRows rows = outputs.rows(0, {kAny, 6});
  for (std::size_t i = 0; i < rows.rows; ++i)
  {
    const float* const row = rows.row(i);
    const int class_id = classOf(row[5], 0, params.classes);
    if (class_id >= 0 && candidates.reaches(row[4], class_id))
      candidates.add(row[4], class_id, i, {row[0], row[1], row[2], row[3]});
  }
}

void findSsd(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  const int first = params.background ? 1 : 0;
  const auto add = [&](std::size_t i, float class_number, float score, const float* corners)
  {
    const int class_id = classOf(class_number, first, params.classes);
    if (class_id >= 0 && candidates.reaches(score, class_id)) addShare(params, score, class_id, i, corners, candidates);
  };
  if (outputs.count() == 1)
  {
    const OutputRows rows = outputs.rows(0, {kAny, 7});
    for (std::size_t i = 0; i < rows.rows; ++i)
    {
      const float* const row = rows.row(i);
      if (row[0] == 0.0F) add(i, row[1], row[2], row + 3);  // others are not of the first image, or fill up
    }
    return;
  }
  outputs.requireCount(3);
  const OutputRows boxes = outputs.rows(0, {kAny, 4});
  const auto n = static_cast<std::int64_t>(boxes.rows);
  const OutputRows classes = outputs.rows(1, {n}), scores = outputs.rows(2, {n});
  for (std::size_t i = 0; i < boxes.rows; ++i)
    add(i, classes.values[i], scores.values[i], boxes.row(i));
}

void findDetr(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  outputs.requireCount(2);
  const OutputRows logits = outputs.rows(0, {kAny, params.classes + 1});
  const OutputRows boxes = outputs.rows(1, {static_cast<std::int64_t>(logits.rows), 4});
  for (std::size_t i = 0; i < logits.rows; ++i)
  {
    const float* const row = logits.row(i);
    const float* const end = row + params.classes;
    const float* const best = std::max_element(row, end);
    const double highest = std::max(*best, *end);
    double sum = 0.0;
    for (const float* logit = row; logit <= end; ++logit)
      sum += std::exp(*logit - highest);
    // NaN where a logit is NaN or infinity: such a row has no score. One of minus infinity is no more than none.
    const auto score = static_cast<float>(std::exp(*best - highest) / sum);
    const auto class_id = static_cast<int>(best - row);
    if (candidates.reaches(score, class_id)) addCenteredShare(params, score, class_id, i, boxes.row(i), candidates);
  }
}

void findRtdetr(const HeadParams& params, const HeadOutputs& outputs, Candidates& candidates)
{
  if (outputs.count() == 1)
  {
    const ScoreKernels& kernel = kernels<ScoreKernels>();
    const OutputRows rows = outputs.rows(0, {kAny, 4 + params.classes});
    for (std::size_t i = 0; i < rows.rows; ++i)
    {
      const float* const row = rows.row(i);
      const BestClass best = bestClass(kernel, row + 4, params.classes, candidates.lowestRank());
      if (best.class_id >= 0 && candidates.reaches(best.score, best.class_id))
        addCenteredShare(params, best.score, best.class_id, i, row, candidates);
    }
    return;
  }
  outputs.requireCount(2);
  const OutputRows logits = outputs.rows(0, {kAny, params.classes});
  const OutputRows boxes = outputs.rows(1, {static_cast<std::int64_t>(logits.rows), 4});
  for (std::size_t i = 0; i < logits.rows; ++i)
  {
    const float* const row = logits.row(i);
    const float* best = nullptr;
    for (const float* logit = row; logit != row + params.classes; ++logit)
      if (std::isfinite(*logit) && (best == nullptr || *logit > *best)) best = logit;
    if (best == nullptr) continue;
    const auto score = static_cast<float>(1.0 / (1.0 + std::exp(-static_cast<double>(*best))));
    const auto class_id = static_cast<int>(best - row);
    if (candidates.reaches(score, class_id)) addCenteredShare(params, score, class_id, i, boxes.row(i), candidates);
  }
}

}  // namespace robot_vision
