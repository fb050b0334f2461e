#pragma once

#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "scene_model.hpp"

// What is where in the TabletopScene, in the world frame.
namespace robot_vision::scene
{

/// The camera at a time of the motion (s).
cv::Affine3d tabletopCamera(double seconds);

/// The rectangles of the table but its top, from the back to the front for a camera that sees it from above.
std::vector<Board> tableSides();
Board tableTop();

/// The middles of discs of these radii (m) on the table's top, so that they do not overlap, each as near to the middle
/// as those before it allow. Less than there are radii: there is no room for the next one.
std::vector<cv::Point2d> placesOnTable(const std::vector<double>& radii);

}  // namespace robot_vision::scene
