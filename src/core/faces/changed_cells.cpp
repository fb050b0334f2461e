#include "changed_cells.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxNoise = 8.0;  // gray levels by which a cell's mean differs between frames of a still room

/// Adds a box, united with all boxes that it overlaps.
void add(cv::Rect box, std::vector<cv::Rect>& boxes)
{
  for (std::size_t i = 0; i < boxes.size();)
  {
    if ((boxes[i] & box).empty())
    {
      ++i;
      continue;
    }
    box |= boxes[i];
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;  // it is larger now
  }
  boxes.push_back(box);
}

}  // namespace

void ChangedCells::update(const cv::Mat& gray)
{
  const cv::Size cells(std::max(gray.cols / cell_, 1), std::max(gray.rows / cell_, 1));
  cv::Mat now, difference;
  cv::resize(gray, now, cells, 0.0, 0.0, cv::INTER_AREA);
  if (image_size_ != gray.size())
  {
    changed_ = cv::Mat::zeros(cells, CV_8UC1);
    image_size_ = gray.size();
    size_ = {static_cast<double>(gray.cols) / cells.width, static_cast<double>(gray.rows) / cells.height};
  }
  else
  {
    cv::absdiff(now, last_, difference);
    cv::compare(difference, kMaxNoise, difference, cv::CMP_GT);
    changed_ |= difference;
  }
  last_ = now;
}

void ChangedCells::ignore(const cv::Rect& part)
{
  const cv::Point first(cvFloor(part.x / size_.x), cvFloor(part.y / size_.y));
  const cv::Point end(cvCeil(part.br().x / size_.x), cvCeil(part.br().y / size_.y));
  changed_(cv::Rect(first, end) & fullRect(changed_)).setTo(0);
}

std::vector<cv::Rect> ChangedCells::take(int border)
{
  cv::Mat labels, boxes, centers;
  const int count = cv::connectedComponentsWithStats(changed_, labels, boxes, centers, 8);
  std::vector<cv::Rect> parts;
  for (int i = 1; i < count; ++i)
  {
    const int* box = boxes.ptr<int>(i);
    const cv::Point first(cvFloor(box[cv::CC_STAT_LEFT] * size_.x), cvFloor(box[cv::CC_STAT_TOP] * size_.y));
    const cv::Point end(cvCeil((box[cv::CC_STAT_LEFT] + box[cv::CC_STAT_WIDTH]) * size_.x),
                        cvCeil((box[cv::CC_STAT_TOP] + box[cv::CC_STAT_HEIGHT]) * size_.y));
    add(grown(cv::Rect(first, end), border, image_size_), parts);
  }
  clear();
  return parts;
}

}  // namespace robot_vision
