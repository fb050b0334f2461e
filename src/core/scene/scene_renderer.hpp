#pragma once

#include <array>

#include "scene_model.hpp"
#include "scene_painter.hpp"
#include "scene_textures.hpp"

namespace robot_vision::scene
{

/// What hangs and stands in the room, with its textures, ready to be drawn.
class Stage
{
public:
  explicit Stage(const cv::Mat& poster_bgr = cv::Mat());

  /// Width over height of the poster.
  double posterAspect() const { return poster_aspect_; }

  /// Draws the room at a time of the motion, in seconds, as a camera (its pose in the world) sees it. Every pixel is
  /// written.
  void paint(double seconds, const cv::Affine3d& camera, const Lens& lens, cv::Mat& bgr) const;

private:
  struct Item
  {
    Texture texture;
    Board board;
  };

  void paintBox(double seconds, const cv::Affine3d& world_in_camera, const Lens& lens, cv::Mat& bgr) const;
  void paintShadows(double seconds, const cv::Affine3d& world_in_camera, const Lens& lens, cv::Mat& bgr) const;

  double poster_aspect_;
  Item floor_;
  std::vector<Item> boards_;      // walls and all that hangs and stands there, from the back to the front
  Texture shadow_;                // of the moving things, on the floor
  std::array<Texture, 3> crate_;  // front, sides, lid
};

}  // namespace robot_vision::scene
