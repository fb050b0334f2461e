#include "face_search.hpp"

#include <algorithm>
#include <utility>

#include "core/image/rects.hpp"

namespace robot_vision
{

FaceWindows FaceWindows::of(const FaceParams& params)
{
  return {{params.scale_factor, params.min_neighbors, params.min_size, params.max_size}};
}

FaceWindows FaceWindows::narrowed(int min_side, int max_side) const
{
  FaceWindows windows = *this;
  windows.smallest = std::max(smallest, min_side);
  windows.largest = largest == 0 ? max_side : std::min(largest, max_side);
  return windows;
}

FaceSearch::FaceSearch(const FaceParams& params) : first_("cascade_1", params.cascade_1)
{
  if (params.cascade_2.empty()) return;
  second_ = Cascade("cascade_2", params.cascade_2);
  views_.insert(views_.end(), {FaceView::kSecond, FaceView::kMirrored});
}

std::vector<FoundFace> FaceSearch::find(const cv::Mat& gray, const cv::Rect& part, const FaceWindows& windows,
                                        const std::atomic<bool>* stop)
{
  std::vector<FoundFace> found = find(FaceView::kFirst, gray, part, windows, stop);
  if (!found.empty() || second_.empty()) return found;
  found = find(FaceView::kSecond, gray, part, windows, stop);
  for (const FoundFace& face : find(FaceView::kMirrored, gray, part, windows, stop))
  {
    const auto same = [&](const FoundFace& other) { return 2 * (face.box & other.box).area() > other.box.area(); };
    const auto known = std::find_if(found.begin(), found.end(), same);
    if (known == found.end())
      found.push_back(face);
    else if (face.neighbors > known->neighbors)
      *known = face;
  }
  return found;
}

std::vector<FoundFace> FaceSearch::find(FaceView view, const cv::Mat& gray, const cv::Rect& part,
                                        const FaceWindows& windows, const std::atomic<bool>* stop)
{
  if (part.empty()) return {};
  cv::Mat pixels;
  if (view == FaceView::kMirrored)
    cv::flip(gray(part), pixels, 1);
  else
    pixels = gray(part);
  Cascade& cascade = view == FaceView::kFirst ? first_ : second_;
  std::vector<int> neighbors;
  const std::vector<cv::Rect> boxes = cascade.find(pixels, windows, neighbors, stop);
  std::vector<FoundFace> found;
  for (std::size_t i = 0; i < boxes.size(); ++i)
  {
    const cv::Rect& box = boxes[i];
    const int x = view == FaceView::kMirrored ? part.width - box.x - box.width : box.x;
    found.push_back({cv::Rect(part.x + x, part.y + box.y, box.width, box.height), neighbors[i], view});
  }
  std::sort(found.begin(), found.end(),
            [](const FoundFace& a, const FoundFace& b) { return a.box.area() > b.box.area(); });
  return found;
}

FaceResult FaceSearch::find(FaceJob job, const std::atomic<bool>& stop)
{
  FaceResult result;
  for (const cv::Rect& part : job.parts)
  {
    const std::vector<FoundFace> found = find(job.gray, part, job.windows, &stop);
    result.found.insert(result.found.end(), found.begin(), found.end());
  }
  result.job = std::move(job);
  return result;
}

}  // namespace robot_vision
