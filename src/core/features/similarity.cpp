#include "similarity.hpp"

#include <opencv2/calib3d.hpp>

namespace robot_vision
{

cv::Point2d Similarity::operator()(const cv::Point2d& p) const
{
  return {a * p.x - b * p.y + shift.x, b * p.x + a * p.y + shift.y};
}

std::vector<cv::Point2f> Similarity::operator()(const std::vector<cv::Point2f>& points) const
{
  std::vector<cv::Point2f> moved;
  for (const cv::Point2f& p : points)
    moved.emplace_back((*this)(cv::Point2d(p)));
  return moved;
}

Similarity Similarity::operator*(const Similarity& inner) const
{
  return {a * inner.a - b * inner.b, b * inner.a + a * inner.b, (*this)(inner.shift)};
}

std::optional<Similarity> fitSimilarity(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& to,
                                        double tolerance, int min_inliers)
{
  if (static_cast<int>(from.size()) < std::max(min_inliers, 2)) return std::nullopt;
  std::vector<uchar> inliers;
  // OpenCV seeds its random numbers anew in each call, so that the result does not depend on chance.
  const cv::Mat fit = cv::estimateAffinePartial2D(from, to, inliers, cv::RANSAC, tolerance, 500, 0.99, 5);
  if (fit.empty() || cv::countNonZero(inliers) < min_inliers) return std::nullopt;
  const cv::Matx23d m = fit;
  return Similarity{m(0, 0), m(1, 0), {m(0, 2), m(1, 2)}};
}

}  // namespace robot_vision
