#include "color_clusters.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "core/common/random_state.hpp"
#include "core/common/work_limit.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxSteps = 20;       // of one attempt
constexpr double kMinMotion = 0.1;  // gray levels of the centres in a step, below which an attempt has ended

constexpr double kMaxDistances = 5e7;  // from pixels to centres in a step of all attempts; some 80 ns for all steps

/// The nearest centre of each colour (CV_32SC1), from 0.
cv::Mat nearestCenters(const cv::Mat_<cv::Vec3f>& colors, const cv::Mat& centers)
{
  cv::Mat_<int> nearest(colors.rows, 1);
  for (int i = 0; i < colors.rows; ++i)
  {
    float best = std::numeric_limits<float>::max();
    for (int center = 0; center < centers.rows; ++center)
    {
      const cv::Vec3f difference = colors(i) - cv::Vec3f(centers.ptr<float>(center));
      const float distance = difference.dot(difference);
      if (distance >= best) continue;
      best = distance;
      nearest(i) = center;
    }
  }
  return nearest;
}

/// The clusters by the number of their colours, the largest first.
std::vector<int> bySize(const cv::Mat_<int>& clusters, int count)
{
  std::vector<int> sizes(count), order(count);
  for (const int cluster : clusters)
    ++sizes[cluster];
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return sizes[a] > sizes[b]; });
  return order;
}

}  // namespace

cv::Mat ColorClusters::apply(const cv::Mat& bgr, const SegmenterParams& params)
{
  const int count = std::min(params.clusters, static_cast<int>(bgr.total()));
  const bool kept = params.keep_centers && centers_.rows == count;
  const int attempts = kept ? 1 : params.attempts;
  requireWork("clusters, attempts are " + toText(count) + ", " + toText(attempts) + " at scale " + toText(params.scale),
              static_cast<double>(count) * attempts, bgr.size(), kMaxDistances);
  cv::Mat colors;
  bgr.convertTo(colors, CV_32F);
  colors = colors.reshape(3, static_cast<int>(bgr.total()));
  cv::Mat_<int> clusters;
  if (kept) clusters = nearestCenters(colors, centers_);
  cv::Mat centers;
  const RandomState state(params.random_seed);
  cv::kmeans(colors, count, clusters, {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kMaxSteps, kMinMotion},
             attempts, kept ? cv::KMEANS_USE_INITIAL_LABELS : cv::KMEANS_PP_CENTERS, centers);
  std::vector<int> order(count), numbers(count);
  std::iota(order.begin(), order.end(), 0);
  if (!kept) order = bySize(clusters, count);
  centers_.create(count, 3, CV_32FC1);
  for (int i = 0; i < count; ++i)
  {
    numbers[order[i]] = i + 1;
    centers.row(order[i]).copyTo(centers_.row(i));
  }
  for (int& cluster : clusters)
    cluster = numbers[cluster];
  return clusters.reshape(1, bgr.rows);
}

}  // namespace robot_vision
