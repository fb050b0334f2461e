#include "cascade.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
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

/// Reads a file that is there. Both stay empty if it has no cascade.
void load(const std::string& path, std::shared_ptr<const HaarCascade>& haar, cv::CascadeClassifier& other)
{
  try
  {
    haar = readHaarCascade(path);
    if (!haar && !other.load(path)) other = cv::CascadeClassifier();
  }
  catch (const cv::Exception&)  // cv::FileStorage cannot read the file
  {
  }
}

std::string problemOf(const std::string& path)
{
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return "there is no such file";
  if (status.type() == fs::file_type::none) return "which cannot be looked at: " + error.message();
  if (!fs::is_regular_file(status)) return "which is no file";
  if (fs::file_size(path, error) == 0) return "which is empty";
  return "";
}

cv::Size scaled(const cv::Size& size, double factor)
{
  return {cvRound(size.width * factor), cvRound(size.height * factor)};
}

/// From one side of a window to the next, as detectMultiScale goes, those that are classified: the factors of the
/// cascade's own window.
std::vector<double> factorsOf(const cv::Size& window, const cv::Size& image, const CascadeWindows& windows)
{
  std::vector<double> factors;
  for (double factor = 1.0;; factor *= windows.scale_factor)
  {
    const cv::Size size = scaled(window, factor);
    if (size.width > image.width || size.height > image.height) return factors;
    if (windows.largest > 0 && std::max(size.width, size.height) > windows.largest) return factors;
    if (std::min(size.width, size.height) >= windows.smallest) factors.push_back(factor);
  }
}

/// By OpenCV. A call cannot be interrupted, so there is one for each size.
std::vector<cv::Rect> search(cv::CascadeClassifier& cascade, const cv::Mat& gray, double scale_factor,
                             const std::vector<double>& factors, const std::atomic<bool>* stop)
{
  const cv::Size window = cascade.getOriginalWindowSize();
  std::vector<cv::Rect> found, all;
  if (!stop)
  {
    const cv::Size smallest = scaled(window, factors.front()), largest = scaled(window, factors.back());
    cascade.detectMultiScale(gray, all, scale_factor, 0, 0, smallest, largest);
    return all;
  }
  cv::Size last;
  for (const double factor : factors)
  {
    if (*stop) return {};
    const cv::Size size = scaled(window, factor);
    if (size == std::exchange(last, size)) continue;  // a call searches with all factors that give this size
    cascade.detectMultiScale(gray, found, scale_factor, 0, 0, size, size);
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

}  // namespace

Cascade::Cascade(const std::string& parameter, const std::string& name)
{
  const std::string path = pathOf(parameter, name);
  std::string problem = problemOf(path);
  if (problem.empty())
  {
    std::shared_ptr<const HaarCascade> haar;
    load(path, haar, other_);
    if (haar) haar_ = std::make_unique<HaarSearch>(std::move(haar));
    if (empty()) problem = "which is no cascade of OpenCV's, or must not be read";
  }
  if (!problem.empty()) throw std::invalid_argument(parameter + " is '" + logLine(path) + "', " + problem);
}

/// The windows in which the cascade sees what it is for.
std::vector<cv::Rect> Cascade::windowsOn(const cv::Mat& gray, const CascadeWindows& windows,
                                         const std::atomic<bool>* stop)
{
  if (empty()) return {};
  const cv::Size window = haar_ ? haar_->cascade().window : other_.getOriginalWindowSize();
  const std::vector<double> factors = factorsOf(window, gray.size(), windows);
  if (factors.empty()) return {};  // OpenCV would search for the nearest size, although it is too small or too large
  return haar_ ? haar_->find(gray, factors, stop) : search(other_, gray, windows.scale_factor, factors, stop);
}

std::vector<cv::Rect> Cascade::find(const cv::Mat& gray, const CascadeWindows& windows, std::vector<int>& neighbors,
                                    const std::atomic<bool>* stop)
{
  std::vector<cv::Rect> boxes = windowsOn(gray, windows, stop);
  neighbors.clear();
  cv::groupRectangles(boxes, neighbors, windows.min_neighbors, kGroupEps);
  for (cv::Rect& box : boxes)
    box &= fullRect(gray);  // windows are rounded, and so is their mean
  return boxes;
}

}  // namespace robot_vision
