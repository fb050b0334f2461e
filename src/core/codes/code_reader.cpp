#include "robot_vision/codes/code_reader.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "code_search.hpp"
#include "code_tracks.hpp"
#include "core/common/background_task.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kSearchesKept = 2.5;  // times of a search in the background that a code is remembered
constexpr double kShort = 0.2;         // of max_search_period: between searches for codes that were lost

cv::Rect wholeOf(const cv::Mat& image)
{
  return {{0, 0}, image.size()};
}

/// The order of codes from top to bottom.
bool isAbove(const Code& a, const Code& b)
{
  const cv::Point2d middle_of_a = a.polygon[0] + a.polygon[2], middle_of_b = b.polygon[0] + b.polygon[2];
  return std::tie(middle_of_a.y, middle_of_a.x) < std::tie(middle_of_b.y, middle_of_b.x);
}

}  // namespace

struct CodeReader::Impl
{
  explicit Impl(const CodeReaderParams& p) : params((validate(p), p)), near(p), whole(p) {}

  cv::Mat grayOf(const cv::Mat& image, const std::string& encoding)
  {
    cv::Mat gray = converted;  // it may come to share the input's pixels, which must not be kept
    toGray(image, encoding, gray);
    if (!sharesPixels(gray, image)) converted = gray;
    return gray;
  }

  void begin(double time_s, const cv::Size& image)
  {
    starts = image != size || time_s <= time;
    if (starts)
    {
      tracks.clear();
      searched.reset();
      background.drop();
    }
    last_time = time;
    time = time_s;
    size = image;
  }

  /// Adds a code of this frame, unless it is among `codes`.
  void take(const Code& code, std::vector<Code>& codes)
  {
    if (std::any_of(codes.begin(), codes.end(), [&code](const Code& known) { return isSame(known, code); })) return;
    codes.push_back(code);
    follow(tracks, time, code);
  }

  /// Searches around the codes that have not been read in this frame.
  void searchNear(const cv::Mat& gray, bool wide, std::vector<Code>& codes)
  {
    for (std::size_t i = 0; i < tracks.size(); ++i)  // there may come to be more
    {
      if (tracks[i].seen >= time) continue;
      const cv::Rect region = tracks[i].regionAt(time, wide, size);
      if (region.empty()) continue;
      const Code wanted = tracks[i].code;
      const cv::Rect part = onLines(region, params.spacing, size);
      for (const Code& code : near.find(gray, part))
        if (saysTheSame(code, wanted) || isWhole(code, part, size)) take(code, codes);
    }
  }

  /// Knows the codes that a search of an earlier frame has found, where they were, to look for them in this one.
  void takeFound()
  {
    const std::optional<std::vector<Code>> found = background.take();
    if (!found) return;
    for (const Code& code : *found)
    {
      const auto isKnown = [&](const CodeTrack& track)
      { return track.seen >= background_time && isSame(track.at(background_time), code); };
      if (std::none_of(tracks.begin(), tracks.end(), isKnown)) follow(tracks, background_time, code);
    }
    search_time = time - background_time;
  }

  /// Whether a code that was read since all was searched last should still be in view and is not.
  bool hasLost() const
  {
    const auto isLost = [this](const CodeTrack& track)
    { return track.seen < time && track.seen >= *searched && track.isInViewAt(time, size); };
    return std::any_of(tracks.begin(), tracks.end(), isLost);
  }

  /// Whether the whole image must be searched in this frame, or else would be too late in the next.
  bool isDue() const
  {
    if (!searched) return true;
    const double since = time - *searched;
    return since + (time - last_time) > params.max_search_period ||
           (since >= kShort * params.max_search_period && hasLost());
  }

  /// Searches the whole image, if it is time to.
  void searchWhole(const cv::Mat& gray, std::vector<Code>& codes)
  {
    const bool at_once = !params.background || params.max_search_period == 0.0 || starts;
    if ((!at_once && background.busy()) || !isDue()) return;
    searched = time;
    if (at_once || !startSearch(gray))
      for (const Code& code : near.find(gray, wholeOf(gray)))
        take(code, codes);
  }

  bool startSearch(const cv::Mat& gray)
  {
    // The input's pixels are its owner's again before the search ends; a converted image can be given away.
    const cv::Mat own = sharesPixels(gray, converted) ? std::exchange(converted, cv::Mat()) : gray.clone();
    background_time = time;
    return background.start([this, own] { return whole.find(own, wholeOf(own)); });
  }

  CodeReaderParams params;
  CodeSearch near;    // by the caller
  CodeSearch whole;   // in the background
  cv::Mat converted;  // memory for the next image
  std::vector<CodeTrack> tracks;
  cv::Size size;                                 // of the last image
  double time = 0.0;                             // s, of the same
  double last_time = 0.0;                        // s, of the one before
  bool starts = true;                            // whether nothing is known of earlier images
  std::optional<double> searched;                // s, when a whole one was searched last
  double background_time = 0.0;                  // s, of the one that is searched in the background
  double search_time = 0.0;                      // s, that the last search in the background took
  BackgroundTask<std::vector<Code>> background;  // uses `whole`, and so goes first
};

CodeReader::CodeReader(const CodeReaderParams& params) : impl_(std::make_unique<Impl>(params))
{
}
CodeReader::~CodeReader() = default;
CodeReader::CodeReader(CodeReader&&) noexcept = default;
CodeReader& CodeReader::operator=(CodeReader&&) noexcept = default;

std::vector<Code> CodeReader::read(const cv::Mat& image, const std::string& encoding)
{
  const cv::Mat gray = impl_->grayOf(image, encoding);
  std::vector<Code> codes = impl_->near.find(gray, wholeOf(gray));
  std::sort(codes.begin(), codes.end(), isAbove);
  return codes;
}

std::vector<Code> CodeReader::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  requireFinite("time_s", time_s);
  Impl& me = *impl_;
  const cv::Mat gray = me.grayOf(image, encoding);
  me.begin(time_s, gray.size());
  me.takeFound();
  std::vector<Code> codes;
  if (me.params.max_search_period > 0.0)
    for (const bool wide : {false, true})
      me.searchNear(gray, wide, codes);
  me.searchWhole(gray, codes);
  // Now, as a search may take longer than the period; and not before a second one can say how a new code moves.
  forget(me.tracks, time_s - std::max(me.params.max_search_period, kSearchesKept * me.search_time));
  std::sort(codes.begin(), codes.end(), isAbove);
  return codes;
}

}  // namespace robot_vision
