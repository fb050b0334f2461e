#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "depth_clusters.hpp"
#include "robot_vision/depth/tabletop.hpp"
#include "robot_vision/geometry/camera_model.hpp"
#include "table_frame.hpp"

namespace robot_vision
{

/// Finds what stands on tables. The objects of all tables of an image are counted.
class TableObjects
{
public:
  TableObjects(const RayTable& rays, double gap, int min_pixels) : rays_(rays), gap_(gap), min_pixels_(min_pixels) {}

  /// Begins with a new image, of this size.
  void begin(const cv::Size& size);

  /// Finds the objects of one table, the one with most pixels first. `depths` is CV_32FC1, m, of what can be one of
  /// them; 0 for all other pixels.
  std::vector<TableObject> find(const cv::Mat& depths, const TableFrame& frame);

  /// See Tabletop.
  const cv::Mat& labels() const { return labels_; }

private:
  /// The pixels that hang together.
  struct Cluster
  {
    int pixels = 0;
    int step = 1;  // of so many pixels one is a sample
    cv::Rect box;
    std::vector<cv::Point2f> samples;  // on the table
    std::vector<float> heights;        // of the samples, m
  };

  std::vector<Cluster> sample(const cv::Mat& depths, const std::vector<int>& pixels, const TableFrame& frame) const;
  void label(const std::vector<std::uint16_t>& numbers);
  static TableObject objectOf(const Cluster& cluster, const TableFrame& frame);

  const RayTable& rays_;
  double gap_;
  int min_pixels_;
  DepthClusters clusters_;
  std::size_t count_ = 0;
  cv::Mat labels_;   // CV_16UC1, objects of all tables
  cv::Mat numbers_;  // CV_32SC1, clusters of one table
};

}  // namespace robot_vision
