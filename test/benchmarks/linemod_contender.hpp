#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <opencv2/rgbd/linemod.hpp>
#include <opencv2/surface_matching.hpp>
#include <vector>

#include "opencv_clouds.hpp"
#include "recognition_trials.hpp"
#include "robot_vision/recognition/view_tree.hpp"

/// cv::linemod as object_recognition_core's pipeline LINEMOD has it: with its views, its threshold, and an ICP.
///
/// Of ORK: 150 directions on a spiral, turns about the line of sight of -80 to 80 degrees in steps of 10, distances of
/// 0.6 and 1.0 m (0.6 to 1.1 in steps of 0.4), which are 5,100 templates; matches of at least 93 %; and of these, after
/// ICP, those of which a quarter of the pixels are at most 0.06 m from the image's depths. Ours: ICP is that of
/// cv::ppf_match_3d, as ORK's own is not in OpenCV; and only the best matches at different places get it, of which ORK
/// has all, which would take seconds of a frame.
class LinemodContender
{
public:
  explicit LinemodContender(const trials::Object& object)
    : object_(&object), detector_(cv::linemod::getDefaultLINEMOD()), camera_(kinectCamera()), mesh_camera_(camera_)
  {
    const double golden = CV_PI * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < kDirections; ++i)
    {
      const double y = 2.0 * (i + 0.5) / kDirections - 1.0, r = std::sqrt(1.0 - y * y);
      const cv::Matx33d rotation =
          robot_vision::lookedAtFrom(cv::Vec3d(std::cos(i * golden) * r, y, std::sin(i * golden) * r));
      for (int turn = -80; turn <= 80; turn += 10)
        for (const double distance : {0.6, 1.0})
          learn(cv::Affine3d(cv::Vec3d(0.0, 0.0, turn * CV_PI / 180.0), cv::Vec3d()).rotation() * rotation, distance);
    }
  }

  /// The best matches, at different places.
  std::vector<cv::linemod::Match> match(const ClutteredFrame& frame) const
  {
    cv::Mat depth;
    frame.depth.convertTo(depth, CV_16UC1, 1000.0);
    depth.setTo(0, frame.depth != frame.depth);
    std::vector<cv::linemod::Match> matches, best;
    detector_->match({frame.bgr, depth}, kThreshold, matches);  // the best come first
    for (const cv::linemod::Match& one : matches)
    {
      const auto is_near = [&](const cv::linemod::Match& other)
      { return std::hypot(one.x - other.x, one.y - other.y) < kApart; };
      if (std::none_of(best.begin(), best.end(), is_near)) best.push_back(one);
      if (best.size() == kRefined) break;
    }
    return best;
  }

  /// The poses of those matches that ICP confirms.
  std::vector<cv::Affine3d> decide(const ClutteredFrame& frame, const std::vector<cv::linemod::Match>& matches) const
  {
    std::vector<cv::Affine3d> poses;
    for (const cv::linemod::Match& match : matches)
    {
      cv::Affine3d pose;
      if (refine(frame, match, pose)) poses.push_back(pose);
    }
    return poses;
  }

private:
  static constexpr int kDirections = 150;
  static constexpr float kThreshold = 93.0F;  // %
  static constexpr std::size_t kRefined = 5;
  static constexpr double kApart = 20.0;  // px
  static constexpr double kGate = 0.06;   // m
  static constexpr double kShare = 0.25;

  struct Template
  {
    cv::Matx33d rotation;
    double distance = 0.0;
    cv::Point corner;  // of its box in its own image
  };

  cv::Affine3d poseOf(const cv::Matx33d& rotation, const cv::Vec3d& middle) const
  {
    return {rotation, middle - rotation * object_->shape->extent().center};
  }

  robot_vision::MeshView draw(const cv::Affine3d& pose) const
  {
    robot_vision::MeshView view;
    object_->shape->renderer().render(mesh_camera_, pose, {0, 0, camera_.width, camera_.height}, view);
    return view;
  }

  /// What is drawn of a view: all of the object and some more, as cv::linemod takes sizes.
  cv::Rect regionOf(double distance) const
  {
    const double radius =
        camera_.K(0, 0) * object_->shape->extent().radius / (distance - object_->shape->extent().radius);
    const int half = 16 * (static_cast<int>(std::ceil(radius / 16.0)) + 1);
    const cv::Rect around(camera_.width / 2 - half, camera_.height / 2 - half, 2 * half, 2 * half);
    return around & cv::Rect(0, 0, camera_.width, camera_.height);
  }

  void learn(const cv::Matx33d& rotation, double distance)
  {
    robot_vision::MeshView view;
    robot_vision::RenderParts parts;
    parts.bgr = true;
    const cv::Rect region = regionOf(distance);
    object_->shape->renderer().render(mesh_camera_, poseOf(rotation, {0.0, 0.0, distance}), region, view, parts);
    const cv::Mat mask = view.depth == view.depth;
    cv::Mat depth;
    view.depth.convertTo(depth, CV_16UC1, 1000.0);
    depth.setTo(0, ~mask);
    cv::Rect box;
    if (detector_->addTemplate({view.bgr, depth}, "object", mask, &box) < 0) return;
    templates_.push_back({rotation, distance, box.tl() + region.tl()});
  }

  bool refine(const ClutteredFrame& frame, const cv::linemod::Match& match, cv::Affine3d& pose) const
  {
    const Template& seen = templates_[static_cast<std::size_t>(match.template_id)];
    const cv::Matx33d K = camera_.K;
    const cv::Vec3d aside((match.x - seen.corner.x) / K(0, 0), (match.y - seen.corner.y) / K(1, 1), 0.0);
    const cv::Vec3d middle = seen.distance * (cv::Vec3d(0.0, 0.0, 1.0) + aside);
    pose = poseOf(seen.rotation, middle);
    std::vector<double> behind = differences(frame, draw(pose).depth);
    if (behind.size() < 50) return false;
    const double farther = bench::median(behind);
    pose = poseOf(seen.rotation, middle * ((seen.distance + farther) / seen.distance));
    const cv::Mat drawn = draw(pose).depth;
    cv::Mat near = frame.depth.clone();
    near.setTo(std::nanf(""), aroundOnly(drawn));
    const cv::Mat model = bench::cloudOf(drawn, frame.camera, 2), scene = bench::cloudOf(near, frame.camera, 2);
    if (model.rows < 30 || scene.rows < 30) return false;
    double residual = 0.0;
    cv::Matx44d moved = cv::Matx44d::eye();
    cv::ppf_match_3d::ICP(100, 0.005F, 2.5F, 8).registerModelToScene(model, scene, residual, moved);
    pose = cv::Affine3d(moved) * pose;
    const cv::Mat last = draw(pose).depth;
    const int all = cv::countNonZero(last == last);
    const std::vector<double> left = differences(frame, last);
    const auto near_ones = std::count_if(left.begin(), left.end(), [](double d) { return std::abs(d) < kGate; });
    return all > 0 && static_cast<double>(near_ones) > kShare * all;
  }

  /// All pixels but those of a box around what was drawn.
  static cv::Mat aroundOnly(const cv::Mat& drawn)
  {
    cv::Rect box = cv::boundingRect(drawn == drawn);
    box = cv::Rect(box.x - 10, box.y - 10, box.width + 20, box.height + 20) & cv::Rect({}, drawn.size());
    cv::Mat outside(drawn.size(), CV_8UC1, cv::Scalar(255));
    outside(box) = 0;
    return outside;
  }

  /// By how much (m) the frame is farther away than what was drawn, where both have a depth.
  static std::vector<double> differences(const ClutteredFrame& frame, const cv::Mat& drawn)
  {
    std::vector<double> found;
    for (int y = 0; y < drawn.rows; ++y)
      for (int x = 0; x < drawn.cols; ++x)
      {
        const float difference = frame.depth.at<float>(y, x) - drawn.at<float>(y, x);
        if (!std::isnan(difference)) found.push_back(static_cast<double>(difference));
      }
    return found;
  }

  const trials::Object* object_;
  cv::Ptr<cv::linemod::Detector> detector_;
  robot_vision::CameraModel camera_;
  robot_vision::MeshCamera mesh_camera_;
  std::vector<Template> templates_;
};
