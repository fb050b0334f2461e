#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "robot_vision/scene/scene.hpp"
#include "support/images.hpp"

inline robot_vision::SceneParams withoutNoise(int width = 640, int height = 480)
{
  return {width, height, 30.0, 1, 0.0};
}

/// A scene without noise. Scenes are slow to build, and they are const, so the tests share this one.
inline const robot_vision::Scene& sharedScene()
{
  static const robot_vision::Scene scene(withoutNoise());
  return scene;
}

inline cv::Mat rendered(const robot_vision::Scene& scene, std::int64_t frame,
                        robot_vision::SceneView view = robot_vision::SceneView::kColor)
{
  cv::Mat image;
  scene.render(frame, image, view);
  return image;
}

inline cv::Mat renderedGray(const robot_vision::Scene& scene, std::int64_t frame,
                            robot_vision::SceneView view = robot_vision::SceneView::kColor)
{
  return converted(rendered(scene, frame, view), cv::COLOR_BGR2GRAY);
}

inline cv::Mat renderedDepth(const robot_vision::Scene& scene, std::int64_t frame,
                             robot_vision::SceneView view = robot_vision::SceneView::kDepth)
{
  cv::Mat depth;
  scene.renderDepth(frame, depth, view);
  return depth;
}

inline robot_vision::SceneObject find(const robot_vision::SceneTruth& truth, const std::string& name)
{
  for (const robot_vision::SceneObject& object : truth.objects)
  {
    if (object.name == name) return object;
  }
  throw std::runtime_error("no " + name);
}

/// The gray level between pixel centres, by linear interpolation.
inline double grayAt(const cv::Mat& gray, const cv::Point2d& p)
{
  const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
  const double fx = p.x - x, fy = p.y - y;
  return (gray.at<uchar>(y, x) * (1 - fx) + gray.at<uchar>(y, x + 1) * fx) * (1 - fy) +
         (gray.at<uchar>(y + 1, x) * (1 - fx) + gray.at<uchar>(y + 1, x + 1) * fx) * fy;
}
