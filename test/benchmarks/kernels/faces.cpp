#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <stdexcept>
#include <tuple>

#include "contests.hpp"
#include "core/faces/haar_search.hpp"

namespace bench
{
namespace
{

constexpr double kStep = 1.2;  // from size to size, and
constexpr int kSmallest = 40;  // px, the defaults of the face detector

std::vector<cv::Rect> sorted(std::vector<cv::Rect> boxes)
{
  const auto key = [](const cv::Rect& box) { return std::tie(box.width, box.y, box.x); };
  std::sort(boxes.begin(), boxes.end(), [&](const cv::Rect& a, const cv::Rect& b) { return key(a) < key(b); });
  return boxes;
}

/// All windows of an image in which a cascade sees a face.
struct CascadeSearch
{
  CascadeSearch(const Setup& setup, const std::string& path) : opencv(path), search(robot_vision::readHaarCascade(path))
  {
    if (opencv.empty()) throw std::runtime_error(path + " is no cascade");
    for (const cv::Mat& bgr : setup.frames)
    {
      cv::cvtColor(bgr, frames.emplace_back(), cv::COLOR_BGR2GRAY);
      cv::equalizeHist(frames.back(), frames.back());
    }
    const cv::Size window = opencv.getOriginalWindowSize(), image = frames.front().size();
    for (double factor = 1.0; cvRound(window.height * factor) <= std::min(image.width, image.height); factor *= kStep)
      if (cvRound(window.height * factor) >= kSmallest) factors.push_back(factor);
  }

  void byOpenCv(std::size_t i) { opencv.detectMultiScale(frames[i], theirs, kStep, 0, 0, {kSmallest, kSmallest}); }

  void byUs(std::size_t i)
  {
    ours = search.find(frames[i], factors);
    for (cv::Rect& box : ours)
      box &= cv::Rect({}, frames[i].size());
  }

  bool same() const { return sorted(theirs) == sorted(ours); }

  cv::CascadeClassifier opencv;
  robot_vision::HaarSearch search;
  std::vector<cv::Mat> frames;
  std::vector<double> factors;
  std::vector<cv::Rect> theirs, ours;
};

Work work(const std::string& name, const std::string& cascade)
{
  const std::string path = "/usr/share/opencv4/haarcascades/haarcascade_" + cascade + ".xml";
  return {name, "CascadeClassifier", 4.0, contestOf<CascadeSearch>(path)};
}

}  // namespace

std::vector<Work> faceWorks()
{
  return {work("faces from the front", "frontalface_default"), work("faces from a side", "profileface")};
}

}  // namespace bench
