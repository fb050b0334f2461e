#include "face_search.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

namespace robot_vision
{
namespace
{

namespace fs = std::filesystem;

/// Where Debian's, Ubuntu's and OpenCV's own packages put the cascades.
const std::vector<std::string> kFolders = {"/usr/share/opencv4/", "/usr/share/opencv/", "/usr/local/share/opencv4/"};

constexpr double kAlike = 0.2;  // of their size, by which windows on one face differ, as in detectMultiScale

std::string pathOf(const std::string& parameter, const std::string& name)
{
  if (name.find('/') != std::string::npos) return name;
  std::string tried;
  for (const std::string& folder : kFolders)
  {
    for (const char* kind : {"haarcascades/", "lbpcascades/"})
    {
      std::string path = folder;
      path += kind;
      if (fs::exists(path + name)) return path + name;
      tried += (tried.empty() ? "" : ", ") + path;
    }
  }
  throw std::invalid_argument(parameter + " is '" + name + "', which is in none of " + tried +
                              " (opencv-data installs them)");
}

bool load(const std::string& path, cv::CascadeClassifier& cascade)
{
  try
  {
    return cascade.load(path);
  }
  catch (const cv::Exception&)  // it is no file of cv::FileStorage at all
  {
    return false;
  }
}

/// The sides of windows between the sizes, growing by `factor` from the cascade's own: those of detectMultiScale.
std::vector<int> windowSides(const cv::Size& window, const cv::Size& picture, const FaceSizes& sizes, double factor)
{
  std::vector<int> sides;
  for (double scale = 1.0;; scale *= factor)
  {
    const cv::Size size(cvRound(window.width * scale), cvRound(window.height * scale));
    if (size.width > picture.width || size.height > picture.height) return sides;
    if (sizes.largest > 0 && std::max(size.width, size.height) > sizes.largest) return sides;
    if (std::min(size.width, size.height) >= sizes.smallest && (sides.empty() || sides.back() != size.width))
      sides.push_back(size.width);
  }
}

/// Every window of the cascade's that is a face.
std::vector<cv::Rect> windows(cv::CascadeClassifier& cascade, const cv::Mat& gray, const FaceSizes& sizes,
                              double factor, const std::atomic<bool>* stop)
{
  const auto search = [&](int smallest, int largest)
  {
    std::vector<cv::Rect> found;
    cascade.detectMultiScale(gray, found, factor, 0, 0, {smallest, smallest}, {largest, largest});
    return found;
  };
  const int largest = sizes.largest > 0 ? sizes.largest : std::max(gray.cols, gray.rows);
  if (!stop) return search(sizes.smallest, largest);
  // One call cannot be ended early, so one for each size.
  std::vector<cv::Rect> all;
  std::vector<int> sides = windowSides(cascade.getOriginalWindowSize(), gray.size(), sizes, factor);
  if (sides.empty()) sides.push_back(sizes.smallest);  // a single size may lie between two steps
  for (const int side : sides)
  {
    if (*stop) return {};
    const std::vector<cv::Rect> found = search(side, side);
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
  std::error_code unknown;
  if (!fs::exists(path))
    wrong = "there is no such file";
  else if (!fs::is_regular_file(path))
    wrong = "which is no file";
  else if (fs::file_size(path, unknown) == 0)
    wrong = "which is empty";
  else if (!load(path, cascade))
    wrong = "which is no cascade of OpenCV's, or must not be read";
  if (!wrong.empty()) throw std::invalid_argument(parameter + " is '" + path + "', " + wrong);
  return cascade;
}

FaceSearch::FaceSearch(const FaceParams& params)
  : scale_factor_(params.scale_factor),
    min_neighbors_(params.min_neighbors),
    first_(readCascade("cascade_1", params.cascade_1))
{
  if (params.cascade_2.empty()) return;
  second_ = readCascade("cascade_2", params.cascade_2);
  views_.insert(views_.end(), {FaceView::kSecond, FaceView::kMirrored});
}

std::vector<FoundFace> FaceSearch::find(const cv::Mat& gray, const cv::Rect& part, const FaceSizes& sizes,
                                        const std::atomic<bool>* stop)
{
  std::vector<FoundFace> found = find(FaceView::kFirst, gray, part, sizes, scale_factor_, stop);
  if (!found.empty() || second_.empty()) return found;
  found = find(FaceView::kSecond, gray, part, sizes, scale_factor_, stop);
  for (const FoundFace& face : find(FaceView::kMirrored, gray, part, sizes, scale_factor_, stop))
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
                                        const FaceSizes& sizes, double scale_factor, const std::atomic<bool>* stop)
{
  if (part.empty()) return {};
  cv::Mat pixels;
  if (view == FaceView::kMirrored)
    cv::flip(gray(part), pixels, 1);
  else
    pixels = gray(part);
  cv::CascadeClassifier& cascade = view == FaceView::kFirst ? first_ : second_;
  std::vector<cv::Rect> boxes = windows(cascade, pixels, sizes, scale_factor, stop);
  std::vector<int> neighbors;
  cv::groupRectangles(boxes, neighbors, min_neighbors_, kAlike);
  std::vector<FoundFace> found;
  for (std::size_t i = 0; i < boxes.size(); ++i)
  {
    if (view == FaceView::kMirrored) boxes[i].x = part.width - boxes[i].x - boxes[i].width;
    found.push_back({boxes[i] + part.tl(), neighbors[i], view});
  }
  std::sort(found.begin(), found.end(),
            [](const FoundFace& a, const FoundFace& b) { return a.box.area() > b.box.area(); });
  return found;
}

}  // namespace robot_vision
