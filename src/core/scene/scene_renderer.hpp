#pragma once

#include <array>

#include "scene_canvas.hpp"
#include "scene_model.hpp"
#include "scene_textures.hpp"

namespace robot_vision::scene
{

/// Draws the room: it holds the objects and their textures.
class SceneRenderer
{
public:
  explicit SceneRenderer(const cv::Mat& poster_bgr = cv::Mat());

  /// Width of the poster over its height.
  double posterAspect() const { return poster_aspect_; }

  /// Draws the room at a time of the motion (s) on a canvas of a camera in which the world has this pose. Writes every
  /// pixel.
  void draw(double seconds, const cv::Affine3d& world, Canvas& canvas) const;

private:
  struct Item
  {
    Texture texture;
    Board board;
  };

  void drawBox(double seconds, const cv::Affine3d& world, Canvas& canvas) const;
  void drawShadows(double seconds, const cv::Affine3d& world, Canvas& canvas) const;

  double poster_aspect_;
  Item floor_;
  std::vector<Item> boards_;      // walls and the boards in front of them, from the back to the front
  Texture shadow_;                // the shadow of a moving object on the floor
  std::array<Texture, 3> crate_;  // front, sides, lid
};

}  // namespace robot_vision::scene
