#pragma once

#include <array>

#include "scene_model.hpp"
#include "scene_painter.hpp"
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

  /// Draws the room at a time of the motion (s) as a camera with this pose in the world sees it. Writes every pixel.
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
  std::vector<Item> boards_;      // walls and the boards in front of them, from the back to the front
  Texture shadow_;                // the shadow of a moving object on the floor
  std::array<Texture, 3> crate_;  // front, sides, lid
};

}  // namespace robot_vision::scene
