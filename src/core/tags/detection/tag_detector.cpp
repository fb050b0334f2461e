#include "robot_vision/tags/detection/tag_detector.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/tags/detection/tag_families.hpp"
#include "tag_searches.hpp"
#include "tag_tracks.hpp"

namespace robot_vision
{
namespace
{

constexpr int kLargest = 8192;         // px: in larger pictures the library may need more stack than a thread has
constexpr double kSearchesKept = 2.5;  // times of a search in the background that a tag is remembered
constexpr double kShort = 0.2;         // of max_search_period: between searches for lost tags, and for large ones
constexpr double kGlance = 4.0;        // decimation at which these are searched for

std::string sizeText(const cv::Size& size)
{
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

bool isDecimation(double value)
{
  return value == 0.0 || value == 1.5 || (value >= 1.0 && value <= 10.0 && value == std::floor(value));
}

/// Lets go of a picture, which may be of the caller's pixels, however the search of it ends.
class PictureGuard
{
public:
  explicit PictureGuard(cv::Mat& picture) : picture_(picture) {}
  ~PictureGuard() { picture_.release(); }
  PictureGuard(const PictureGuard&) = delete;
  PictureGuard& operator=(const PictureGuard&) = delete;

private:
  cv::Mat& picture_;
};

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
  checkFields(params);
}

struct TagDetector::Impl
{
  explicit Impl(const TagDetectorParams& p) : params((validate(p), p)), searches(p) {}

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
    const std::vector<std::vector<Tag>> found = searches.find(gray, regions);
    std::vector<Tag> tags;
    for (std::size_t i = 0; i < regions.size(); ++i)
      for (const Tag& tag : found[i])
        if (isWhole(tag, regions[i], gray.size())) merge(tags, {tag});
    return tags;
  }

  /// Adds tags of this frame that are not yet among `tags`.
  void take(const std::vector<Tag>& found, std::vector<Tag>& tags)
  {
    const std::size_t known = tags.size();
    merge(tags, found);
    follow(tracks, time, {tags.begin() + static_cast<std::ptrdiff_t>(known), tags.end()});
  }

  /// Whether a tag of the frame that was searched in the background was seen in it, or has been since.
  bool isKnown(const Tag& tag) const
  {
    const auto seenSince = [&](const TagTrack& track)
    { return track.seen >= known_time && isSame(track.at(known_time), tag); };
    return std::any_of(known.begin(), known.end(), [&tag](const Tag& other) { return isSame(other, tag); }) ||
           std::any_of(tracks.begin(), tracks.end(), seenSince);
  }

  /// Knows the tags that a search of an earlier frame has found, where they were, to look for them in this one.
  void takeFound()
  {
    const std::optional<std::vector<Tag>> found = searches.take();
    if (!found) return;
    std::vector<Tag> tags;
    for (const Tag& tag : *found)
      if (!isKnown(tag)) tags.push_back(tag);
    follow(tracks, known_time, tags);
    search_time = time - known_time;
  }

  /// Whether a tag that was seen since all was searched last should still be in view and is not.
  bool hasLost() const
  {
    const auto lost = [this](const TagTrack& track)
    { return track.seen < time && track.seen >= *searched && track.isInViewAt(time, gray.size()); };
    return std::any_of(tracks.begin(), tracks.end(), lost);
  }

  /// Whether the whole picture must be searched in this frame, or else would be too late in the next.
  bool isDue(double last_time) const
  {
    if (!searched) return true;
    const double since = time - *searched;
    return since + (time - last_time) > params.max_search_period ||
           (since >= kShort * params.max_search_period && hasLost());
  }

  /// Searches the whole picture, if it is time to. `tags` are those of this frame so far.
  void searchWhole(double last_time, std::vector<Tag>& tags)
  {
    const bool at_once = !params.background || params.max_search_period == 0.0 || starts;
    if (!at_once && searches.busy()) return;
    const bool due = isDue(last_time);
    if (!due && (params.decimate != 0.0 || time - glanced < kShort * params.max_search_period)) return;
    const double decimate = due ? finest() : kGlance;
    if (due) searched = time;
    glanced = time;
    if (at_once)
    {
      take(searches.find(gray, decimate), tags);
      return;
    }
    known = tags;
    known_time = time;
    // The input's pixels are its owner's again before the search ends; a converted picture can be given away.
    const cv::Mat own = sharesPixels(gray, converted) ? std::exchange(converted, cv::Mat()) : gray.clone();
    lacks_threads = !searches.start(own, decimate);
    if (lacks_threads) take(searches.find(gray, decimate), tags);
  }

  void beginAnew()
  {
    tracks.clear();
    searched.reset();
    searches.drop();
    starts = true;
  }

  TagDetectorParams params;
  TagSearches searches;
  std::vector<TagTrack> tracks;
  cv::Mat converted;               // memory for the next picture
  cv::Mat gray;                    // the picture, while it is searched
  cv::Size size;                   // of the last one
  double time = 0.0;               // s, of the last one
  bool starts = true;              // whether it is the first one
  std::optional<double> searched;  // s, when a whole one was searched last
  double glanced = 0.0;            // s, when one was, for large tags at least
  std::vector<Tag> known;          // in the frame that is searched in the background
  double known_time = 0.0;         // s, of this frame
  double search_time = 0.0;        // s, that the last search in the background took
  bool lacks_threads = false;      // whether none could be started for it
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
  me.searches.configure(params);
  me.params = params;
  me.searched.reset();
}

void TagDetector::waitForSearch() const
{
  impl_->searches.wait();
}

bool TagDetector::lacksThreads() const
{
  return impl_->lacks_threads;
}

void TagDetector::abandonSearch()
{
  impl_->searches.abandon();
}

std::vector<Tag> TagDetector::detect(const cv::Mat& image, const std::string& encoding)
{
  Impl& me = *impl_;
  const PictureGuard guard(me.gray);
  me.setPicture(image, encoding);
  std::vector<Tag> tags = me.searches.find(me.gray, me.finest());
  me.sort(tags);
  return tags;
}

std::vector<Tag> TagDetector::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  requireFinite("time_s", time_s);
  Impl& me = *impl_;
  const PictureGuard guard(me.gray);
  me.setPicture(image, encoding);
  if (me.gray.size() != me.size || time_s <= me.time) me.beginAnew();
  const double last_time = me.time;
  me.size = me.gray.size();
  me.time = time_s;
  me.takeFound();
  std::vector<Tag> tags;
  if (me.params.max_search_period > 0.0)
    for (const bool again : {false, true})
      me.take(me.searchNear(again), tags);
  me.searchWhole(last_time, tags);
  // Now, as a search may take longer than the period; and not before a second one can say how a new tag moves.
  forget(me.tracks, time_s - std::max(me.params.max_search_period, kSearchesKept * me.search_time));
  me.starts = false;
  me.sort(tags);
  return tags;
}

}  // namespace robot_vision
