#include "flow_image.hpp"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

namespace robot_vision
{
namespace
{

const cv::TermCriteria kCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 15, 0.02);

}  // namespace

void FlowImage::set(const cv::Mat& gray)
{
  gray.copyTo(gray_);
  built_ = false;
}

const std::vector<cv::Mat>& FlowImage::pyramid(const FlowParams& params)
{
  if (built_ && window_ == params.window && levels_ == params.levels) return pyramid_;
  cv::buildOpticalFlowPyramid(gray_, pyramid_, {params.window, params.window}, params.levels, true);
  window_ = params.window;
  levels_ = params.levels;
  built_ = true;
  return pyramid_;
}

const cv::Mat& FlowImage::halved(const FlowParams& params, int& halvings)
{
  const std::vector<cv::Mat>& images = pyramid(params);
  halvings = std::clamp(halvings, 0, static_cast<int>(images.size()) / 2 - 1);
  return halvings == 0 ? gray_ : images[2 * static_cast<std::size_t>(halvings)];
}

FollowedPoints followPoints(FlowImage& last, FlowImage& next, const FlowParams& params,
                            const std::vector<cv::Point2f>& points, const std::vector<cv::Point2f>& guess)
{
  FollowedPoints followed{guess, {}, {}};
  if (points.empty()) return followed;
  const cv::Size window(params.window, params.window);
  std::vector<cv::Point2f> back = points;
  std::vector<uchar> found_back;
  std::vector<float> unused;
  const auto follow = [&](FlowImage& from, FlowImage& to, const std::vector<cv::Point2f>& begin,
                          std::vector<cv::Point2f>& end, std::vector<uchar>& found)
  {
    cv::calcOpticalFlowPyrLK(from.pyramid(params), to.pyramid(params), begin, end, found, unused, window, params.levels,
                             kCriteria, cv::OPTFLOW_USE_INITIAL_FLOW);
  };
  follow(last, next, points, followed.positions, followed.found);
  follow(next, last, followed.positions, back, found_back);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const double error = cv::norm(back[i] - points[i]);
    followed.found[i] = followed.found[i] && found_back[i] && error <= params.max_error;
    followed.errors.push_back(static_cast<float>(error));
  }
  return followed;
}

bool isInside(const cv::Size& image, const cv::Point2f& p)
{
  return p.x >= 0.0F && p.y >= 0.0F && p.x <= static_cast<float>(image.width - 1) &&
         p.y <= static_cast<float>(image.height - 1);
}

}  // namespace robot_vision
