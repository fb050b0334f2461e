#include "claimed_pixels.hpp"

#include <cstdint>

#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

/// Calls work(block) with the pixels of the image that each explained one of a verdict stands for.
template <class Work>
void forExplained(const PoseVerdict& verdict, const cv::Mat& image, const Work& work)
{
  for (int y = 0; y < verdict.explained.rows; ++y)
    for (int x = 0; x < verdict.explained.cols; ++x)
    {
      if (verdict.explained.at<std::uint8_t>(y, x) == 0) continue;
      const cv::Point corner = verdict.box.tl() + verdict.step * cv::Point(x, y);
      work(cv::Rect(corner, cv::Size(verdict.step, verdict.step)) & fullRect(image));
    }
}

}  // namespace

void ClaimedPixels::begin(const cv::Size& image)
{
  claimed_.create(image, CV_8UC1);
  claimed_.setTo(0);
}

double ClaimedPixels::unclaimed(const PoseVerdict& verdict) const
{
  int all = 0, left = 0;
  forExplained(verdict, claimed_,
               [&](const cv::Rect& block)
               {
                 ++all;
                 left += claimed_.at<std::uint8_t>(block.tl()) == 0 ? 1 : 0;
               });
  return all > 0 ? static_cast<double>(left) / all : 0.0;
}

void ClaimedPixels::claim(const PoseVerdict& verdict)
{
  forExplained(verdict, claimed_, [&](const cv::Rect& block) { claimed_(block).setTo(255); });
}

}  // namespace robot_vision
