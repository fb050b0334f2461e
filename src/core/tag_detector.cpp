#include "robot_vision/tag_detector.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "robot_vision/encoding.hpp"
#include "robot_vision/range.hpp"
#include "robot_vision/tag_families.hpp"
#include "tag_search.hpp"
#include "tag_tracks.hpp"

namespace robot_vision
{
namespace
{

constexpr int kLargest = 8192;   // px: in larger pictures the library may need more stack than a thread has
constexpr double kShort = 0.2;   // of max_search_period: between searches for lost tags, and for large ones
constexpr double kGlance = 4.0;  // decimation at which these are searched for

std::string sizeText(const cv::Size& size)
{
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

bool isDecimation(double value)
{
  return value == 0.0 || value == 1.5 || (value >= 1.0 && value <= 10.0 && value == std::floor(value));
}

}  // namespace

void validate(const TagDetectorParams& params)
{
  require(!params.families.empty(), "families", "empty", "at least one");
  for (const std::string& name : params.families)
  {
    tagFamily(name);
    const auto count = std::count(params.families.begin(), params.families.end(), name);
    require(count == 1, "families", name + " twice", "each once");
  }
  require(isDecimation(params.decimate), "decimate", params.decimate, "0 (by the tag's size), 1, 1.5, 2, 3, ... or 10");
  requireRange("blur", params.blur, -5.0, 5.0);
  requireRange("max_hamming", params.max_hamming, 0.0, 2.0);
  requireRange("min_margin", params.min_margin, 0.0, 255.0);
  requireRange("min_similarity", params.min_similarity, -1.0, 1.0);
  requireRange("max_search_period", params.max_search_period, 0.0, 60.0);
}

struct TagDetector::Impl
{
  explicit Impl(const TagDetectorParams& p) : params((validate(p), p)), search(p) {}

  void setPicture(const cv::Mat& image, const std::string& encoding)
  {
    gray = converted;  // it may come to share the input's pixels, which must not be kept
    toGray(image, encoding, gray);
    require(std::max(gray.cols, gray.rows) <= kLargest, "image", sizeText(gray.size()),
            "at most " + std::to_string(kLargest) + " px wide and high");
    if (!sharesPixels(gray, image)) converted = gray;
  }

  void sort(std::vector<Tag>& tags) const
  {
    const auto order = [this](const Tag& tag)
    {
      const auto family = std::find(params.families.begin(), params.families.end(), tag.family);
      return std::make_tuple(family, tag.id, tag.center.x, tag.center.y);
    };
    std::sort(tags.begin(), tags.end(), [&order](const Tag& a, const Tag& b) { return order(a) < order(b); });
  }

  std::vector<Tag> searchAll(double decimate) { return search.find(gray, cv::Rect({0, 0}, gray.size()), decimate); }

  double finest() const { return params.decimate == 0.0 ? 1.0 : params.decimate; }

  /// Around the tags that have not been seen in this frame; `again`: in full resolution, where less was chosen.
  std::vector<Tag> searchNear(bool again)
  {
    std::vector<TagRegion> regions;
    for (const TagTrack& track : tracks)
    {
      if (track.seen >= time) continue;
      TagRegion region = track.regionAt(time, params.decimate, gray.size());
      if (again && (region.decimate == 1.0 || params.decimate != 0.0)) continue;
      if (again) region = track.regionAt(time, 1.0, gray.size());
      if (!region.part.empty()) regions.push_back(region);
    }
    join(regions);
    std::vector<Tag> tags;
    for (const TagRegion& region : regions)
      for (const Tag& tag : search.find(gray, region.part, region.decimate))
        if (isWhole(tag, region, gray.size())) merge(tags, {tag});
    return tags;
  }

  /// Adds tags of this frame that are not yet among `tags`.
  void take(const std::vector<Tag>& found, std::vector<Tag>& tags)
  {
    const std::size_t known = tags.size();
    merge(tags, found);
    follow(tracks, time, {tags.begin() + static_cast<std::ptrdiff_t>(known), tags.end()}, params.max_search_period);
  }

  /// Whether a tag of the last frame should still be in view and is not.
  bool hasLost(double last_time) const
  {
    const cv::Rect2d view({0.0, 0.0}, cv::Size2d(gray.size()));
    const auto lost = [&](const TagTrack& track)
    {
      const auto corners = track.cornersAt(time);
      return track.seen == last_time &&
             std::all_of(corners.begin(), corners.end(),
                         [&view](const cv::Point2d& corner) { return view.contains(corner); });
    };
    return std::any_of(tracks.begin(), tracks.end(), lost);
  }

  /// Whether the whole picture must be searched in this frame, or else would be too late in the next.
  bool isDue(double last_time) const
  {
    if (!searched) return true;
    const double since = time - *searched;
    return since + (time - last_time) > params.max_search_period ||
           (since >= kShort * params.max_search_period && hasLost(last_time));
  }

  TagDetectorParams params;
  TagSearch search;
  std::vector<TagTrack> tracks;
  cv::Mat converted;               // memory for the next picture
  cv::Mat gray;                    // the picture, while it is searched
  cv::Size size;                   // of the last one
  double time = 0.0;               // s, of the last one
  std::optional<double> searched;  // s, when a whole one was searched last
  double glanced = 0.0;            // s, when one was, for large tags at least
};

TagDetector::TagDetector(const TagDetectorParams& params) : impl_(std::make_unique<Impl>(params))
{
}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

void TagDetector::configure(const TagDetectorParams& params)
{
  validate(params);
  Impl& me = *impl_;
  me.search.configure(params);
  me.params = params;
  me.searched.reset();
}

std::vector<Tag> TagDetector::detect(const cv::Mat& image, const std::string& encoding)
{
  Impl& me = *impl_;
  me.setPicture(image, encoding);
  std::vector<Tag> tags = me.searchAll(me.finest());
  me.gray.release();
  me.sort(tags);
  return tags;
}

std::vector<Tag> TagDetector::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  requireFinite("time_s", time_s);
  Impl& me = *impl_;
  me.setPicture(image, encoding);
  if (me.gray.size() != me.size || time_s <= me.time)
  {
    me.tracks.clear();
    me.searched.reset();
  }
  const double last_time = me.time;
  me.size = me.gray.size();
  me.time = time_s;
  std::vector<Tag> tags;
  if (me.params.max_search_period > 0.0)
    for (const bool again : {false, true})
      me.take(me.searchNear(again), tags);
  if (me.isDue(last_time))
  {
    me.take(me.searchAll(me.finest()), tags);
    me.searched = me.glanced = time_s;
  }
  else if (me.params.decimate == 0.0 && time_s - me.glanced >= kShort * me.params.max_search_period)
  {
    me.take(me.searchAll(kGlance), tags);
    me.glanced = time_s;
  }
  me.gray.release();
  me.sort(tags);
  return tags;
}

}  // namespace robot_vision
