#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <ostream>
#include <string>
#include <tuple>

#include "core/faces/haar_search.hpp"
#include "support/images.hpp"
#include "support/temp_folder.hpp"

using namespace robot_vision;

namespace
{

const std::string kFolder = "/usr/share/opencv4/haarcascades/haarcascade_";

std::vector<cv::Rect> sorted(std::vector<cv::Rect> boxes)
{
  const auto key = [](const cv::Rect& box) { return std::tie(box.width, box.height, box.y, box.x); };
  std::sort(boxes.begin(), boxes.end(), [&](const cv::Rect& a, const cv::Rect& b) { return key(a) < key(b); });
  return boxes;
}

/// The factors of the windows of at least `smallest` px that detectMultiScale classifies.
std::vector<double> factorsOf(const cv::Size& window, const cv::Size& image, double step, int smallest)
{
  std::vector<double> factors;
  for (double factor = 1.0;; factor *= step)
  {
    const cv::Size size(cvRound(window.width * factor), cvRound(window.height * factor));
    if (size.width > image.width || size.height > image.height) return factors;
    if (std::min(size.width, size.height) >= smallest) factors.push_back(factor);
  }
}

/// A cascade for both, read once: that takes longer than a search.
class Cascades
{
public:
  explicit Cascades(const std::string& path) : path_(path), opencv_(path), ours_(readHaarCascade(path))
  {
    if (!ours_) throw std::runtime_error(path + " is not read");
  }

  /// Searches with both, expects the same windows, and returns how many.
  std::size_t compare(const cv::Mat& gray, double step = 1.2, int smallest = 1)
  {
    const cv::Mat before = gray.clone();
    std::vector<cv::Rect> expected;
    const std::vector<double> factors = factorsOf(ours_->window, gray.size(), step, smallest);
    if (!factors.empty()) opencv_.detectMultiScale(gray, expected, step, 0, 0, {smallest, smallest});
    HaarSearch search(ours_);
    const std::vector<cv::Rect> found = search.find(gray, factors);
    std::vector<cv::Rect> inside = found;  // OpenCV cuts off what sticks out
    for (cv::Rect& box : inside)
      box &= cv::Rect({}, gray.size());
    EXPECT_EQ(sorted(inside), sorted(expected)) << path_ << ", " << gray.size() << ", " << step << ", " << smallest;
    EXPECT_EQ(search.find(gray, factors), found) << "of the second search";
    EXPECT_EQ(cv::norm(gray, before, cv::NORM_INF), 0.0);
    return found.size();
  }

private:
  std::string path_;
  cv::CascadeClassifier opencv_;
  std::shared_ptr<const HaarCascade> ours_;
};

/// A cascade of random features that many windows pass.
class RandomCascade
{
public:
  RandomCascade(std::uint64_t seed, const cv::Size& window) : random_(seed), window_(window) {}

  void write(const std::string& path)
  {
    cv::FileStorage file(path, cv::FileStorage::WRITE);
    file << "cascade"
         << "{"
         << "stageType"
         << "BOOST"
         << "featureType"
         << "HAAR";
    file << "height" << window_.height << "width" << window_.width;
    file << "stageParams"
         << "{"
         << "maxWeakCount" << kStumps << "}";
    file << "featureParams"
         << "{"
         << "maxCatCount" << 0 << "}"
         << "stageNum" << kStages << "stages"
         << "[";
    for (int stage = 0; stage < kStages; ++stage)
      writeStage(file, stage);
    file << "]"
         << "features"
         << "[";
    for (int i = 0; i < kStages * kStumps; ++i)
      writeFeature(file, i % 3 == 0);
    file << "]"
         << "}";
  }

private:
  static constexpr int kStages = 5;
  static constexpr int kStumps = 7;

  /// The votes are such that their sum often is what the threshold is, once OpenCV has lowered that, or a little less:
  /// the difference that a float just has.
  void writeStage(cv::FileStorage& file, int stage)
  {
    file << "{"
         << "maxWeakCount" << kStumps << "stageThreshold" << -1.0 + 1e-5 + stage % 2 * 6e-8 << "weakClassifiers"
         << "[";
    for (int i = 0; i < kStumps; ++i)
    {
      const double vote = 0.25 * random_.uniform(1, 4);
      file << "{"
           << "internalNodes"
           << "[" << 0 << -1 << stage * kStumps + i << random_.uniform(-0.02, 0.02) << "]";
      file << "leafValues"
           << "[" << -vote << vote << "]"
           << "}";
    }
    file << "]"
         << "}";
  }

  void writeFeature(cv::FileStorage& file, bool three)
  {
    const int width = 3 * random_.uniform(1, window_.width / 3 + 1);
    const int height = random_.uniform(1, window_.height + 1);
    const int x = random_.uniform(0, window_.width - width + 1), y = random_.uniform(0, window_.height - height + 1);
    file << "{"
         << "rects"
         << "[";
    writeRectangle(file, {x, y, width, height}, -1);
    writeRectangle(file, {x + width / 3, y, width / 3, height}, three ? 2 : 3);
    if (three) writeRectangle(file, {x, y, width / 3, height}, 1);
    file << "]"
         << "tilted" << 0 << "}";
  }

  static void writeRectangle(cv::FileStorage& file, const cv::Rect& box, int weight)
  {
    file << "[" << box.x << box.y << box.width << box.height << static_cast<double>(weight) << "]";
  }

  cv::RNG random_;
  cv::Size window_;
};

/// Something with light and dark parts of all sizes.
cv::Mat cloudy(const cv::Size& size)
{
  cv::Mat image = noise(size, CV_8UC1), blurred, sum = cv::Mat::zeros(size, CV_32F);
  for (const double sigma : {1.0, 3.0, 8.0})
  {
    cv::GaussianBlur(image, blurred, {}, sigma, sigma, cv::BORDER_REFLECT_101);
    cv::Mat floats;
    blurred.convertTo(floats, CV_32F, sigma, -127.0 * sigma);
    sum += floats;
  }
  sum.convertTo(image, CV_8U, 2.0, 127.0);
  return image;
}

}  // namespace

TEST(HaarSearch, FindsTheWindowsThatOpenCvFindsWithItsCascades)
{
  for (const char* name : {"frontalface_default", "profileface", "eye", "frontalface_alt", "frontalcatface"})
  {
    Cascades cascades(kFolder + name + ".xml");
    for (const cv::Size& size : {cv::Size(320, 240), cv::Size(211, 157), cv::Size(64, 150), cv::Size(25, 25)})
    {
      cascades.compare(cloudy(size), 1.1);
      cascades.compare(noise(size, CV_8UC1, 5), 1.3, 30);
    }
  }
}

TEST(HaarSearch, FindsTheWindowsThatOpenCvFindsWithRandomCascades)
{
  const TempFolder folder;
  std::size_t found = 0, searched = 0;
  for (int seed = 1; seed <= 12; ++seed)
  {
    const cv::Size window(9 + seed % 5 * 4, 8 + seed % 3 * 7);
    const std::string path = (folder.path() / "cascade.xml").string();
    RandomCascade(static_cast<std::uint64_t>(seed), window).write(path);
    Cascades cascades(path);
    for (const cv::Size& size : {cv::Size(160, 120), cv::Size(97, 81), window, window + cv::Size(1, 2)})
      for (const double step : {1.05, 1.5})
      {
        found += cascades.compare(cloudy(size), step);
        searched += 1;
      }
  }
  EXPECT_GT(found, 100 * searched);
}

TEST(HaarSearch, FlatImagesHaveNothing)
{
  const TempFolder folder;
  const std::string path = (folder.path() / "cascade.xml").string();
  RandomCascade(1, {20, 20}).write(path);
  Cascades cascades(path);
  for (const int gray : {0, 90, 255})
  {
    const cv::Mat flat(60, 80, CV_8UC1, cv::Scalar(gray));
    EXPECT_EQ(cascades.compare(flat), 0U);
    cv::Mat half = flat.clone();  // from windows with nothing to windows with some
    half.colRange(40, 80) += 3 * cloudy({40, 60}) / 255;
    cascades.compare(half);
  }
}

TEST(HaarSearch, SquaresMayOverflow)
{
  const TempFolder folder;
  const std::string path = (folder.path() / "cascade.xml").string();
  RandomCascade(3, {20, 20}).write(path);
  const cv::Mat bright = cloudy({1280, 960}) / 2 + 127;  // 2^32 is reached after 120,000 of these pixels
  EXPECT_GT(Cascades(path).compare(bright, 1.9), 1000U);
}

TEST(HaarSearch, EndsEarly)
{
  const TempFolder folder;
  const std::string path = (folder.path() / "cascade.xml").string();
  RandomCascade(1, {20, 20}).write(path);
  std::atomic<bool> stop{true};
  HaarSearch search(readHaarCascade(path));
  EXPECT_TRUE(search.find(cloudy({160, 120}), {1.0, 2.0}, &stop).empty());
  stop = false;
  EXPECT_FALSE(search.find(cloudy({160, 120}), {1.0, 2.0}, &stop).empty());
}

TEST(HaarSearch, CascadesOfOtherKindsAreLeftToOpenCv)
{
  for (const char* name : {"haarcascades/haarcascade_frontalface_alt2.xml",     // trees of two nodes
                           "haarcascades/haarcascade_upperbody.xml",            // tilted rectangles
                           "lbpcascades/lbpcascade_frontalface_improved.xml"})  // local binary patterns
    EXPECT_EQ(readHaarCascade(std::string("/usr/share/opencv4/") + name), nullptr) << name;
}
