#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "line_fit.hpp"

namespace robot_vision::lanes
{

/// The measures of a lane, as Lane has them: those of concentric arcs.
struct LaneModel
{
  double offset = 0.0, heading = 0.0, curvature = 0.0, width = 0.0;

  /// The place (m, in the robot's frame) after `along` m on the lane's middle, from where the robot is beside it.
  cv::Point2d middle(double along) const;
};

/// Which fits are the lines of the lane that the robot is in.
struct LanePair
{
  const LineFit* left = nullptr;
  const LineFit* right = nullptr;
};

/// Whether a line may be of a lane in the frame after it: the lanes beside it have others at one and a half widths from
/// its middle, so that half a width is left for the robot's way.
bool mayBeOf(const LaneModel& last, const LineFit& line);

/// The best pair of lines that are parallel and as far apart as those of a lane; the best line alone if there is none.
/// A single line is the one that is nearer in `last`, or the one on its side of the robot.
LanePair choosePair(const std::vector<LineFit>& fits, const LaneParams& params, const std::optional<LaneModel>& last);

/// The arcs that fit the places of both lines best. With a single line the width is `width`. None if these are no
/// lane's: curved too much, or of another width.
std::optional<LaneModel> fitLane(const LanePair& pair, double width, const LaneParams& params);

}  // namespace robot_vision::lanes
