#include "rgbd_files_source.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <locale>
#include <sstream>
#include <tuple>

#include "image_files_source.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

namespace fs = std::filesystem;

/// The number that is the name of a file but for its ending; negative if that is no number with a point.
double stampOf(const std::string& file)
{
  const std::string name = fs::path(file).stem().string();
  const auto in_number = [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; };
  const bool is_number = std::all_of(name.begin(), name.end(), in_number) &&
                         std::count(name.begin(), name.end(), '.') == 1 && name.size() > 1;
  if (!is_number) return -1.0;
  std::istringstream text(name);
  text.imbue(std::locale::classic());
  double stamp = -1.0;
  text >> stamp;
  return stamp;
}

/// The stamps of files; empty if not all of them have one.
std::vector<double> stampsOf(const std::vector<std::string>& files)
{
  std::vector<double> stamps;
  std::transform(files.begin(), files.end(), std::back_inserter(stamps), stampOf);
  const bool all = std::all_of(stamps.begin(), stamps.end(), [](double stamp) { return stamp >= 0.0; });
  return all ? stamps : std::vector<double>();
}

/// Indices of a color image and a depth image and the time between both, s.
using Candidate = std::tuple<double, std::size_t, std::size_t>;

std::vector<Candidate> candidates(const std::vector<double>& colors, const std::vector<double>& depths)
{
  std::vector<std::size_t> order(depths.size());  // of the names as numbers, whose lengths may differ
  for (std::size_t i = 0; i < order.size(); ++i)
    order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depths[a] < depths[b]; });
  std::vector<Candidate> found;
  for (std::size_t i = 0; i < colors.size(); ++i)
  {
    const auto is_before = [&](std::size_t depth, double stamp) { return depths[depth] < stamp; };
    auto j = std::lower_bound(order.begin(), order.end(), colors[i] - kMaxRgbdGap, is_before);
    for (; j != order.end() && depths[*j] <= colors[i] + kMaxRgbdGap; ++j)
      found.emplace_back(std::abs(depths[*j] - colors[i]), i, *j);
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<RgbdFiles> pairedByStamp(const std::vector<std::string>& colors, const std::vector<double>& color_stamps,
                                     const std::vector<std::string>& depths, const std::vector<double>& depth_stamps)
{
  std::vector<bool> color_used(colors.size()), depth_used(depths.size());
  std::vector<RgbdFiles> pairs;
  for (const auto& [gap, color, depth] : candidates(color_stamps, depth_stamps))
  {
    if (color_used[color] || depth_used[depth]) continue;
    color_used[color] = depth_used[depth] = true;
    pairs.push_back({colors[color], depths[depth], color_stamps[color]});
  }
  std::sort(pairs.begin(), pairs.end(), [](const RgbdFiles& a, const RgbdFiles& b) { return a.stamp < b.stamp; });
  return pairs;
}

std::string countText(std::size_t count, const std::string& what)
{
  return std::to_string(count) + " " + what + (count == 1 ? " image" : " images");
}

/// The mean rate of files with stamps, or the one that other files have.
double rateOf(const std::vector<RgbdFiles>& files)
{
  const double span = files.back().stamp - files.front().stamp;
  const double rate = span > 0.0 ? static_cast<double>(files.size() - 1) / span : 0.0;
  return rate > 0.0 && rate <= 1000.0 ? rate : kDefaultRate;
}

}  // namespace

std::vector<RgbdFiles> listRgbdFiles(const std::string& path)
{
  const fs::path color_folder = fs::path(path) / "rgb", depth_folder = fs::path(path) / "depth";
  std::error_code ignored;
  if (!fs::is_directory(color_folder, ignored) || !fs::is_directory(depth_folder, ignored))
    throw SourceError(path + ": expected the folders rgb and depth in it, as views is rgbd");
  const std::vector<std::string> colors = listImageFiles(color_folder.string());
  const std::vector<std::string> depths = listImageFiles(depth_folder.string());
  const std::vector<double> color_stamps = stampsOf(colors), depth_stamps = stampsOf(depths);
  if (!color_stamps.empty() && !depth_stamps.empty())
  {
    const std::vector<RgbdFiles> pairs = pairedByStamp(colors, color_stamps, depths, depth_stamps);
    if (pairs.empty())
      throw SourceError(path + ": no color image and depth image are within " + toText(kMaxRgbdGap) +
                        " s of each other by their names");
    return pairs;
  }
  if (colors.size() != depths.size())
    throw SourceError(path + ": " + countText(colors.size(), "color") + " and " + countText(depths.size(), "depth") +
                      ": expected as many of both, or names that are stamps in s, 1305031102.175304.png");
  std::vector<RgbdFiles> pairs;
  std::transform(colors.begin(), colors.end(), depths.begin(), std::back_inserter(pairs),
                 [](const std::string& color, const std::string& depth) {
                   return RgbdFiles{color, depth, 0.0};
                 });
  return pairs;
}

RgbdFilesSource::RgbdFilesSource(const std::string& path, double depth_scale)
  : path_(path), depth_scale_(depth_scale), files_(path, listRgbdFiles(path)), rate_(rateOf(files_.all()))
{
}

ReadResult RgbdFilesSource::read(Frame& frame)
{
  frame.encoding = "bgr8";
  return files_.read(
      frame,
      [this, &frame](const RgbdFiles& files)
      {
        frame.image = frame.wanted.first ? readImage(files.color) : cv::Mat();
        frame.second = {frame.wanted.second ? readDepths(files.depth, depth_scale_) : cv::Mat(), "16UC1"};
      });
}

std::string RgbdFilesSource::description() const
{
  return countText(files_.all().size(), "color and depth") + " at " + toText(rate_) + " Hz from " + path_;
}

}  // namespace robot_vision
