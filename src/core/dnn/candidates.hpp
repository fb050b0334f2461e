#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "robot_vision/dnn/head_decoder.hpp"

namespace robot_vision
{

/// A box that a network gives, in px of its input. An oriented one is turned around its middle by `angle`.
struct Candidate
{
  float score;
  int class_id;
  std::size_t index;  // which of the network's boxes it is
  CornerBox box;
  double angle = 0.0;  // rad, from x towards y
};

/// What a network gives of each of its boxes besides box and scores.
struct ExtraValues
{
  const float* values = nullptr;
  std::size_t box_step = 0;    // from one box to the next
  std::size_t value_step = 0;  // from one value of a box to the next
  std::size_t count = 0;       // values of a box

  float at(std::size_t box, std::size_t value) const { return values[box * box_step + value * value_step]; }
};

/// Collects boxes whose scores reach the thresholds.
class Candidates
{
public:
  explicit Candidates(const HeadParams& params);

  /// The lowest threshold of all, and its rank (score_kernels.hpp).
  float lowest() const { return lowest_; }
  std::int32_t lowestRank() const { return lowest_rank_; }

  /// Whether a score is finite and at least the threshold of its class.
  bool reaches(float score, int class_id) const;

  /// Adds a box by its corners unless it has no area or is not finite.
  void add(float score, int class_id, std::size_t index, const CornerBox& box, double angle = 0.0);

  /// The same by its centre.
  void addCentered(float score, int class_id, std::size_t index, double x, double y, double width, double height,
                   double angle = 0.0);

  std::vector<Candidate> found;
  ExtraValues extras;

private:
  std::vector<float> thresholds_;  // one for each class, or one for all
  float lowest_;
  std::int32_t lowest_rank_;
};

}  // namespace robot_vision
