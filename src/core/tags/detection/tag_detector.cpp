#include "robot_vision/tags/detection/tag_detector.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "core/common/search_schedule.hpp"
#include "core/image/conversion_buffer.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/tags/detection/tag_families.hpp"
#include "tag_searches.hpp"
#include "tag_tracks.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxSide = 8192;           // px: in larger images the library may need more stack than a thread has
constexpr double kCoarseDecimate = 4.0;  // of the searches that find large tags early

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
  checkFields(params);
}

struct TagDetector::Impl
{
  explicit Impl(const TagDetectorParams& p) : params((validate(p), p)), searches(p) {}

  void configure(const TagDetectorParams& p)
  {
    validate(p);
    searches.configure(p);
    params = p;
    schedule.reset();
  }

  std::vector<Tag> detect(const cv::Mat& image, const std::string& encoding)
  {
    std::vector<Tag> tags = searches.find(grayOf(image, encoding), fullDecimate());
    sort(tags);
    return tags;
  }

  std::vector<Tag> update(double time_s, const cv::Mat& image, const std::string& encoding)
  {
    requireFinite("time_s", time_s);
    const cv::Mat gray = grayOf(image, encoding);
    begin(time_s, gray.size());
    takeFound();
    std::vector<Tag> tags;
    if (params.max_search_period > 0.0)
      for (const bool in_full_resolution : {false, true})
        add(searchAroundTracks(gray, in_full_resolution), tags);
    searchWhole(gray, tags);
    schedule.forgetOld(params.max_search_period, tracks);
    sort(tags);
    return tags;
  }

  /// The image in gray. Refuses one that is too large for the library.
  cv::Mat grayOf(const cv::Mat& image, const std::string& encoding)
  {
    cv::Mat gray = buffer.gray(image, encoding);
    require(std::max(gray.cols, gray.rows) <= kMaxSide, "image", toText(gray.size()),
            "at most " + std::to_string(kMaxSide) + " px wide and high");
    return gray;
  }

  /// Begins a frame, and forgets all tags if it has nothing to do with the frames before.
  void begin(double time_s, const cv::Size& image)
  {
    if (!schedule.begin(time_s, image)) return;
    tracks.clear();
    searches.drop();
  }

  /// Orders tags by family, id and place.
  void sort(std::vector<Tag>& tags) const
  {
    const auto order = [this](const Tag& tag)
    {
      const auto family = std::find(params.families.begin(), params.families.end(), tag.family);
      return std::make_tuple(family, tag.id, tag.center.x, tag.center.y);
    };
    std::sort(tags.begin(), tags.end(), [&order](const Tag& a, const Tag& b) { return order(a) < order(b); });
  }

  /// The decimation with which whole images are searched for tags of all sizes.
  double fullDecimate() const { return params.decimate == 0.0 ? 1.0 : params.decimate; }

  /// Searches around the tags that have not been seen in this frame: first in the resolution that suits their size, and
  /// then `in_full_resolution`, where that is another one.
  std::vector<Tag> searchAroundTracks(const cv::Mat& gray, bool in_full_resolution)
  {
    std::vector<TagRegion> regions;
    for (const TagTrack& track : tracks)
    {
      if (track.seen >= schedule.time()) continue;
      TagRegion region = track.regionAt(schedule.time(), params.decimate, gray.size());
      if (in_full_resolution && (region.decimate == 1.0 || params.decimate != 0.0)) continue;
      if (in_full_resolution) region = track.regionAt(schedule.time(), 1.0, gray.size());
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

  /// Adds those of the tags found in this frame that are not yet among `tags`.
  void add(const std::vector<Tag>& found, std::vector<Tag>& tags)
  {
    const std::size_t known = tags.size();
    merge(tags, found);
    follow(tracks, schedule.time(), {tags.begin() + static_cast<std::ptrdiff_t>(known), tags.end()});
  }

  /// Follows the tags that the search in the background has found, from its frame on: all but those that update() saw
  /// in that frame, or has seen since.
  void takeFound()
  {
    const std::optional<std::vector<Tag>> found = searches.take();
    if (!found) return;
    const double searched = schedule.endBackground();
    std::vector<Tag> tags;
    for (const Tag& tag : *found)
    {
      const auto seenBefore = [&](const Tag& other) { return isSame(other, tag); };
      const auto seenSince = [&](const TagTrack& track)
      { return track.seen >= searched && isSame(track.at(searched), tag); };
      if (std::none_of(seen_before.begin(), seen_before.end(), seenBefore) &&
          std::none_of(tracks.begin(), tracks.end(), seenSince))
        tags.push_back(tag);
    }
    follow(tracks, searched, tags);
  }

  /// Searches the whole image if that is due, or coarsely, for large tags. `tags` are those of this frame so far.
  void searchWhole(const cv::Mat& gray, std::vector<Tag>& tags)
  {
    const double period = params.max_search_period;
    const bool at_once = !params.background || period == 0.0 || schedule.isFirst();
    if (!at_once && searches.busy()) return;
    const bool is_due = schedule.isDue(period, tracks);
    const bool is_coarse_due =
        params.decimate == 0.0 && schedule.time() - coarsely_searched >= SearchSchedule::minGap(period);
    if (!is_due && !is_coarse_due) return;
    if (is_due) schedule.setSearched();
    coarsely_searched = schedule.time();
    const double decimate = is_due ? fullDecimate() : kCoarseDecimate;
    if (at_once || !startSearch(gray, decimate, tags)) add(searches.find(gray, decimate), tags);
  }

  /// Begins to search the whole image in the background. Returns false if there is no thread for it.
  bool startSearch(const cv::Mat& gray, double decimate, const std::vector<Tag>& tags)
  {
    seen_before = tags;
    schedule.startBackground();
    lacks_threads = !searches.start(buffer.detach(gray), decimate);
    return !lacks_threads;
  }

  TagDetectorParams params;
  TagSearches searches;
  ConversionBuffer buffer;
  SearchSchedule schedule;
  std::vector<TagTrack> tracks;
  double coarsely_searched = 0.0;  // s, the newest frame that was searched for large tags at least
  std::vector<Tag> seen_before;    // by update(), in the frame that is searched in the background
  bool lacks_threads = false;      // whether no thread could be started for the last search in the background
};

TagDetector::TagDetector(const TagDetectorParams& params) : impl_(std::make_unique<Impl>(params))
{
}
TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

void TagDetector::configure(const TagDetectorParams& params)
{
  impl_->configure(params);
}

std::vector<Tag> TagDetector::detect(const cv::Mat& image, const std::string& encoding)
{
  return impl_->detect(image, encoding);
}

std::vector<Tag> TagDetector::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  return impl_->update(time_s, image, encoding);
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

}  // namespace robot_vision
