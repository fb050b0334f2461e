#include "face_search.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "core/image/rects.hpp"
#include "robot_vision/common/printable.hpp"

namespace robot_vision
{
namespace
{

namespace fs = std::filesystem;

/// Where Debian's, Ubuntu's and OpenCV's own packages put the cascades.
const std::vector<std::string> kCascadeFolders = {"/usr/share/opencv4/", "/usr/share/opencv/",
                                                  "/usr/local/share/opencv4/"};

constexpr double kGroupEps = 0.2;  // of their size, by which windows on one face differ, as in detectMultiScale

std::string pathOf(const std::string& parameter, const std::string& name)
{
  if (name.find('/') != std::string::npos) return name;
  std::string tried;
  for (const std::string& folder : kCascadeFolders)
  {
    for (const char* kind : {"haarcascades/", "lbpcascades/"})
    {
      std::string path = folder;
      path += kind;
      std::error_code unknown;
      if (fs::exists(path + name, unknown)) return path + name;
      tried += (tried.empty() ? "" : ", ") + path;
    }
  }
  throw std::invalid_argument(parameter + " is '" + shortened(name) + "', which is in none of " + tried +
                              " (opencv-data installs them)");
}

bool load(const std::string& path, cv::CascadeClassifier& cascade)
{
  try
  {
    return cascade.load(path);
  }
  catch (const cv::Exception&)  // cv::FileStorage cannot read the file
  {
    return false;
  }
}

/// The sizes of windows, from the cascade's own upwards, that detectMultiScale classifies.
std::vector<cv::Size> windowSizes(const cv::Size& window, const cv::Size& image, const FaceWindows& windows)
{
  std::vector<cv::Size> sizes;
  for (double scale = 1.0;; scale *= windows.scale_factor)
  {
    const cv::Size size(cvRound(window.width * scale), cvRound(window.height * scale));
    if (size.width > image.width || size.height > image.height) return sizes;
    if (windows.largest > 0 && std::max(size.width, size.height) > windows.largest) return sizes;
    if (std::min(size.width, size.height) >= windows.smallest && (sizes.empty() || sizes.back() != size))
      sizes.push_back(size);
  }
}

/// All windows in which the cascade sees a face.
std::vector<cv::Rect> search(cv::CascadeClassifier& cascade, const cv::Mat& gray, const FaceWindows& windows,
                             const std::atomic<bool>* stop)
{
  const std::vector<cv::Size> sizes = windowSizes(cascade.getOriginalWindowSize(), gray.size(), windows);
  if (sizes.empty()) return {};  // OpenCV would search for the nearest size, although it is too small or too large
  std::vector<cv::Rect> found;
  if (!stop)
  {
    cascade.detectMultiScale(gray, found, windows.scale_factor, 0, 0, sizes.front(), sizes.back());
    return found;
  }
  // A call cannot be interrupted, so there is one for each size.
  std::vector<cv::Rect> all;
  for (const cv::Size& size : sizes)
  {
    if (*stop) return {};
    cascade.detectMultiScale(gray, found, windows.scale_factor, 0, 0, size, size);
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

}  // namespace

cv::CascadeClassifier readCascade(const std::string& parameter, const std::string& name)
{
  const std::string path = pathOf(parameter, name);
  cv::CascadeClassifier cascade;
  std::string wrong;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found)
    wrong = "there is no such file";
  else if (status.type() == fs::file_type::none)
    wrong = "which cannot be looked at: " + error.message();
  else if (!fs::is_regular_file(status))
    wrong = "which is no file";
  else if (fs::file_size(path, error) == 0)
    wrong = "which is empty";
  else if (!load(path, cascade))
    wrong = "which is no cascade of OpenCV's, or must not be read";
  if (!wrong.empty()) throw std::invalid_argument(parameter + " is '" + logLine(path) + "', " + wrong);
  return cascade;
}

FaceWindows FaceWindows::of(const FaceParams& params)
{
  return {params.scale_factor, params.min_neighbors, params.min_size, params.max_size};
}

FaceWindows FaceWindows::narrowed(int min_side, int max_side) const
{
  FaceWindows windows = *this;
  windows.smallest = std::max(smallest, min_side);
  windows.largest = largest == 0 ? max_side : std::min(largest, max_side);
  return windows;
}

FaceSearch::FaceSearch(const FaceParams& params) : first_(readCascade("cascade_1", params.cascade_1))
{
  if (params.cascade_2.empty()) return;
  second_ = readCascade("cascade_2", params.cascade_2);
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
  cv::CascadeClassifier& cascade = view == FaceView::kFirst ? first_ : second_;
  std::vector<cv::Rect> boxes = search(cascade, pixels, windows, stop);
  std::vector<int> neighbors;
  cv::groupRectangles(boxes, neighbors, windows.min_neighbors, kGroupEps);
  std::vector<FoundFace> found;
  for (std::size_t i = 0; i < boxes.size(); ++i)
  {
    const cv::Rect box = boxes[i] & fullRect(pixels);  // a rounded mean of windows may stick out
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
