#include "robot_vision/codes/code_reader.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "code_search.hpp"
#include "code_tracks.hpp"
#include "core/common/background_task.hpp"
#include "core/common/search_schedule.hpp"
#include "core/common/work_limit.hpp"
#include "core/image/conversion_buffer.hpp"
#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxPixels = 1e8;  // of an image that is searched, enlarged; of noise some 60 ns each

/// The order of codes from top to bottom.
bool isAbove(const Code& a, const Code& b)
{
  const cv::Point2d middle_of_a = a.polygon[0] + a.polygon[2], middle_of_b = b.polygon[0] + b.polygon[2];
  return std::tie(middle_of_a.y, middle_of_a.x) < std::tie(middle_of_b.y, middle_of_b.x);
}

}  // namespace

struct CodeReader::Impl
{
  explicit Impl(const CodeReaderParams& p) : params((validate(p), p)), all(p), whole(p) {}

  std::vector<Code> read(const cv::Mat& image, const std::string& encoding)
  {
    requireSearch(image.size());
    const cv::Mat gray = buffer.gray(image, encoding);
    std::vector<Code> codes = all.find(gray, fullRect(gray));
    std::sort(codes.begin(), codes.end(), isAbove);
    return codes;
  }

  std::vector<Code> update(double time_s, const cv::Mat& image, const std::string& encoding)
  {
    requireFinite("time_s", time_s);
    requireSearch(image.size());
    const cv::Mat gray = buffer.gray(image, encoding);
    begin(time_s, gray.size());
    takeFound();
    std::vector<Code> codes;
    if (params.max_search_period > 0.0)
      for (const bool wide : {false, true})
        searchAroundTracks(gray, wide, codes);
    searchWhole(gray, codes);
    schedule.forgetOld(params.max_search_period, tracks);
    std::sort(codes.begin(), codes.end(), isAbove);
    return codes;
  }

  void requireSearch(const cv::Size& image) const
  {
    requireWork("enlarge is " + toText(params.enlarge), params.enlarge * params.enlarge, image, kMaxPixels);
  }

  /// Begins a frame, and forgets all codes if it has nothing to do with the frames before.
  void begin(double time_s, const cv::Size& image)
  {
    if (!schedule.begin(time_s, image)) return;
    tracks.clear();
    background.drop();
  }

  /// Adds a code of this frame, unless it is among `codes`.
  void add(const Code& code, std::vector<Code>& codes)
  {
    if (std::any_of(codes.begin(), codes.end(), [&code](const Code& known) { return isSame(known, code); })) return;
    codes.push_back(code);
    follow(tracks, schedule.time(), code);
  }

  /// The search for codes of one type alone, which takes less time.
  CodeSearch& searchFor(const std::string& type)
  {
    CodeReaderParams of_type = params;
    of_type.symbologies = type;
    return near.try_emplace(type, of_type).first->second;
  }

  /// Searches around the codes that have not been read in this frame, each for those of its type, with a larger margin
  /// if `wide`.
  void searchAroundTracks(const cv::Mat& gray, bool wide, std::vector<Code>& codes)
  {
    for (std::size_t i = 0; i < tracks.size(); ++i)  // add() may append tracks
    {
      if (tracks[i].seen >= schedule.time()) continue;
      const cv::Rect region = tracks[i].regionAt(schedule.time(), wide, gray.size());
      if (region.empty()) continue;
      const Code wanted = tracks[i].code;
      const cv::Rect part = alignedToScanLines(region, params.spacing, gray.size());
      for (const Code& code : searchFor(wanted.type).find(gray, part))
        if (haveSameContent(code, wanted) || isWhole(code, part, gray.size())) add(code, codes);
    }
  }

  /// Follows the codes that the search in the background has found, from its frame on: all but those that have been
  /// read since.
  void takeFound()
  {
    const std::optional<std::vector<Code>> found = background.take();
    if (!found) return;
    const double searched = schedule.endBackground();
    for (const Code& code : *found)
    {
      const auto isKnown = [&](const CodeTrack& track)
      { return track.seen >= searched && isSame(track.at(searched), code); };
      if (std::none_of(tracks.begin(), tracks.end(), isKnown)) follow(tracks, searched, code);
    }
  }

  /// Searches the whole image if that is due.
  void searchWhole(const cv::Mat& gray, std::vector<Code>& codes)
  {
    const bool at_once = !params.background || params.max_search_period == 0.0 || schedule.isFirst();
    if (!at_once && background.busy()) return;
    if (!schedule.isDue(params.max_search_period, tracks)) return;
    schedule.setSearched();
    if (at_once || !startSearch(gray))
      for (const Code& code : all.find(gray, fullRect(gray)))
        add(code, codes);
  }

  /// Begins to search the whole image in the background. Returns false if there is no thread for it.
  bool startSearch(const cv::Mat& gray)
  {
    schedule.startBackground();
    return background.start([this, own = buffer.detach(gray)] { return whole.find(own, fullRect(own)); });
  }

  CodeReaderParams params;
  CodeSearch all;                          // used by the caller's thread
  std::map<std::string, CodeSearch> near;  // by type, likewise
  CodeSearch whole;                        // used in the background
  ConversionBuffer buffer;
  SearchSchedule schedule;
  std::vector<CodeTrack> tracks;
  BackgroundTask<std::vector<Code>> background;  // is destroyed first, as it uses `whole`
};

CodeReader::CodeReader(const CodeReaderParams& params) : impl_(std::make_unique<Impl>(params))
{
}
CodeReader::~CodeReader() = default;
CodeReader::CodeReader(CodeReader&&) noexcept = default;
CodeReader& CodeReader::operator=(CodeReader&&) noexcept = default;

std::vector<Code> CodeReader::read(const cv::Mat& image, const std::string& encoding)
{
  return impl_->read(image, encoding);
}

std::vector<Code> CodeReader::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  return impl_->update(time_s, image, encoding);
}

}  // namespace robot_vision
