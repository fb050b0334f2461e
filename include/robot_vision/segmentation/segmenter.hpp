#pragma once

#include <cstddef>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/segmentation/regions.hpp"

namespace robot_vision
{

struct SegmenterParams
{
  std::string method = "watershed";
  double scale = 0.5;
  double min_area = 100.0;
  int max_segments = 100;
  bool keep_labels = true;
  bool automatic = true;
  int seed_radius = 5;
  int border = 4;
  int iterations = 3;
  int clusters = 4;
  int attempts = 3;
  bool keep_centers = true;
  int random_seed = 1;
  double spatial_radius = 10.0;
  double color_radius = 20.0;
  int levels = 1;
  double color_tolerance = 3.0;
  double lower_difference = 10.0;
  double upper_difference = 10.0;
  bool fixed_range = false;
  std::string objects = "auto";
  int opening = 3;
  double peak_height = 0.6;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &SegmenterParams::method,
          OneOf{"watershed, grab_cut, k_means, mean_shift, flood_fill or distance_transform"}, "",
          "how the image is divided");
    visit("scale", &SegmenterParams::scale, Range{0.05, 1}, "",
          "size of the image that is worked on, to that of the whole image");
    visit("min_area", &SegmenterParams::min_area, Range{0, 1e9}, "px^2", "smallest segment; smaller ones are left out");
    visit("max_segments", &SegmenterParams::max_segments, Range{1, 1000}, "",
          "so many segments are kept, the largest ones");
    visit("keep_labels", &SegmenterParams::keep_labels, Anything{}, "",
          "mean_shift, distance_transform, automatic: a segment has the number of the one that was there before");
    visit("automatic", &SegmenterParams::automatic, Anything{}, "",
          "watershed: without seeds, find them as distance_transform does");
    visit("seed_radius", &SegmenterParams::seed_radius, Range{0, 100}, "px",
          "watershed, grab_cut: of the disc around a clicked pixel");
    visit("border", &SegmenterParams::border, Range{0, 1000}, "px",
          "watershed, grab_cut with clicks only: so much along the edges of the image is background; 0: none");
    visit("iterations", &SegmenterParams::iterations, Range{1, 10}, "", "grab_cut: how often it is refined");
    visit("clusters", &SegmenterParams::clusters, Range{1, 32}, "", "k_means: number of colours");
    visit("attempts", &SegmenterParams::attempts, Range{1, 10}, "",
          "k_means: beginnings of which the best is taken, unless centres are kept");
    visit("keep_centers", &SegmenterParams::keep_centers, Anything{}, "",
          "k_means: begin with the colours of the last frame, which keep their numbers");
    visit("random_seed", &SegmenterParams::random_seed, Range{0, 1e9}, "",
          "k_means, grab_cut: the same one gives the same result");
    visit("spatial_radius", &SegmenterParams::spatial_radius, Range{0, 50}, "px", "mean_shift: of the window");
    visit("color_radius", &SegmenterParams::color_radius, Range{0, 255}, "gray levels", "mean_shift: of the window");
    visit("levels", &SegmenterParams::levels, Range{0, 8}, "",
          "mean_shift: halvings of the image, in the smallest of which it begins");
    visit("color_tolerance", &SegmenterParams::color_tolerance, Range{0, 255}, "gray levels",
          "mean_shift: neighbours of one segment differ by no more, in each channel");
    visit("lower_difference", &SegmenterParams::lower_difference, Range{0, 255}, "gray levels",
          "flood_fill: by how much a pixel may be darker, in each channel");
    visit("upper_difference", &SegmenterParams::upper_difference, Range{0, 255}, "gray levels",
          "flood_fill: by how much a pixel may be brighter, in each channel");
    visit("fixed_range", &SegmenterParams::fixed_range, Anything{}, "",
          "flood_fill: compare with the seed, not with the neighbour");
    visit("objects", &SegmenterParams::objects, OneOf{"auto, bright or dark"}, "",
          "distance_transform, automatic: what objects are; auto goes by the edges of the image");
    visit(
        "opening", &SegmenterParams::opening, OddRange{1, 31}, "px",
        "distance_transform, automatic: diameter of the opening, which removes specks, at least 3 px of the image that "
        "is worked on; 1: none");
    visit("peak_height", &SegmenterParams::peak_height, Range{0.05, 1}, "",
          "distance_transform, automatic: a seed is where the distance to the outline is this share of the largest");
  }
};

/// What a segmentation found.
struct Segmentation
{
  cv::Mat labels;    // CV_16UC1: 1, 2, ... are segments; 0 is background, a line between segments, or left out
  cv::Mat centers;   // CV_32FC1, (n, 3), BGR: of k_means, the colour of each label; else empty
  std::string hint;  // what the method lacks, for people; empty: nothing
};

/// What somebody has pointed at, in px of the whole image.
struct SegmentSeed
{
  cv::Rect region;  // dragged; empty: none, but a click
  cv::Point point;  // clicked, or the middle of the region
};

/// Divides images into segments by OpenCV's methods.
///
/// - watershed: cv::watershed. Each seed is a marker, a region or a disc around a click.
/// - grab_cut: cv::grabCut. The object is in the dragged regions, or if there are none inside of the border, and the
///   discs around clicks belong to it.
/// - k_means: cv::kmeans of the colours. All pixels of one colour are a segment.
/// - mean_shift: cv::pyrMeanShiftFiltering; neighbours of about the same colour are a segment.
/// - flood_fill: cv::floodFill from each seed, as far as no earlier one has come.
/// - distance_transform: the image is thresholded by Otsu's method; the places that are farthest from the outlines
///   (cv::distanceTransform) are the markers of cv::watershed, which divides things that touch.
///
/// What has seeds numbers its segments as the seeds came, k_means by the size in its first frame, and the others by
/// size; see keep_labels and keep_centers. The same images and seeds give the same result each time; the state of
/// OpenCV's random numbers stays as it is. Threads may share one; their calls wait for each other.
class Segmenter
{
public:
  static constexpr std::size_t kMaxSeeds = 100;

  /// Throws std::invalid_argument as validate() does.
  explicit Segmenter(const SegmenterParams& params = SegmenterParams());
  ~Segmenter();

  /// Other parameters from now on; seeds and numbers stay. Throws as the constructor does, and then changes nothing.
  void configure(const SegmenterParams& params);

  /// Adds a region (px of the whole image) or a pixel as a seed. Throws std::invalid_argument if the region is empty,
  /// something is farther away than any image is large, or more than kMaxSeeds would be there. What lies outside of an
  /// image is ignored there.
  void addRegion(const cv::Rect& region);
  void addPoint(const cv::Point& point);
  void clearSeeds();
  std::vector<SegmentSeed> seeds() const;

  /// Divides an image, which is not modified. Throws std::invalid_argument if it is not an image of `encoding` (see
  /// encoding.hpp), or so large that the method would take many seconds.
  Segmentation apply(const cv::Mat& image, const std::string& encoding);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A segment of a label image. The outline and the circle are those of its largest piece; area, box and centre are of
/// all its pixels.
struct Segment
{
  int label = 0;
  Region region;
};

/// The segments of a label image (CV_16UC1), the largest first. Throws std::invalid_argument for another type.
std::vector<Segment> findSegments(const cv::Mat& labels);

struct SegmentPaintParams
{
  double opacity = 0.5;
  std::string paint = "distinct";
  bool outlines = true;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("opacity", &SegmentPaintParams::opacity, Range{0, 1}, "", "of the colours over the image");
    visit("paint", &SegmentPaintParams::paint, OneOf{"distinct or mean"}, "",
          "colours that differ from each other, or the mean colour of each segment");
    visit("outlines", &SegmentPaintParams::outlines, Anything{}, "", "white lines between segments");
  }
};

/// Paints each segment of `labels` (CV_16UC1, of the same size) over the image (CV_8UC3), and white lines between
/// them. `out` is reused if it fits, and must not share pixels with `bgr`. Throws std::invalid_argument as validate()
/// does, and if the images do not fit.
void paintSegments(const cv::Mat& bgr, const cv::Mat& labels, const SegmentPaintParams& params, cv::Mat& out);

/// Draws regions as rectangles and clicks as circles into an image (CV_8UC3).
void drawSeeds(cv::Mat& bgr, const std::vector<SegmentSeed>& seeds);

}  // namespace robot_vision
