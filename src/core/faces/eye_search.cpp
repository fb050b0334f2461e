#include "eye_search.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

constexpr int kFaceWidth = 128;  // px, to which faces are scaled
constexpr int kMinNeighbors = 3;

}  // namespace

std::vector<cv::Rect> findEyes(Cascade& cascade, const cv::Mat& gray, const cv::Rect& face)
{
  const cv::Rect box = face & fullRect(gray);
  if (cascade.empty() || box.empty()) return {};
  const cv::Rect upper(box.x, box.y, box.width, std::max(box.height * 3 / 5, 1));
  const double scale = static_cast<double>(kFaceWidth) / upper.width;
  cv::Mat pixels;
  cv::resize(gray(upper), pixels, {kFaceWidth, cvCeil(upper.height * scale)});
  std::vector<int> neighbors;
  const std::vector<cv::Rect> found =
      cascade.find(pixels, {1.1, kMinNeighbors, kFaceWidth / 8, kFaceWidth * 2 / 5}, neighbors);
  // Of each half of the face the one on which most windows agree.
  std::vector<cv::Rect> eyes;
  for (const bool left : {true, false})
  {
    int best = -1;
    for (int i = 0; i < static_cast<int>(found.size()); ++i)
      if ((2 * found[i].x + found[i].width < kFaceWidth) == left && (best < 0 || neighbors[i] > neighbors[best]))
        best = i;
    if (best < 0) continue;
    const cv::Rect& eye = found[best];
    eyes.emplace_back(upper.x + cvRound(eye.x / scale), upper.y + cvRound(eye.y / scale), cvRound(eye.width / scale),
                      cvRound(eye.height / scale));
  }
  return eyes;
}

}  // namespace robot_vision
