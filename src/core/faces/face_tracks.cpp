#include "face_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/image/rects.hpp"

namespace robot_vision
{
namespace
{

constexpr int kTemplateSide = 32;         // px
constexpr double kMinCorrelation = 0.7;   // with its template, at which a face is still believed to be there
constexpr double kNearScaleFactor = 1.1;  // from size to size around a known face, where small steps cost little
constexpr double kMinSizeRatio = 0.75;    // of a known face to its size before
constexpr double kMaxSizeRatio = 1.35;
constexpr double kVelocityGain = 0.15;    // weight of the newest motion in the velocity
constexpr double kMinFramePeriod = 1e-3;  // s between frames from which a velocity is measured
constexpr double kMaxAbsence = 2.0;       // s after which a face that comes back is another one
constexpr double kMinOverlap = 0.5;       // of two boxes of one face, of the area of the smaller one
constexpr int kMissWeight = 2;            // of a frame in which a face is missed in its trust, where a sight counts 1
constexpr int kMaxTrust = 30;             // frames
constexpr int kTrustToHold = 10;          // frames, from which on a face is held for as long as it may be
constexpr std::size_t kMaxHistory = 128;  // frames

cv::Point2d middle(const cv::Rect& box)
{
  return {box.x + 0.5 * box.width, box.y + 0.5 * box.height};
}

/// Whether two boxes are of one face: most of the smaller lies in the other.
bool isSame(const cv::Rect& a, const cv::Rect& b)
{
  return (a & b).area() > kMinOverlap * std::min(a.area(), b.area());
}

/// How far from its expected place a face may be after this time, in sides of its box.
double uncertainty(double seconds)
{
  return std::clamp(0.2 + 2.0 * seconds, 0.25, 1.0);
}

cv::Rect boxAt(const FaceTrack& track, double time_s)
{
  const auto nearer = [&](const auto& a, const auto& b)
  { return std::abs(a.first - time_s) < std::abs(b.first - time_s); };
  return std::min_element(track.past.begin(), track.past.end(), nearer)->second;
}

/// Where the face should be if it goes on as it moved.
cv::Rect expectedBox(const FaceTrack& track, double time_s)
{
  const cv::Point2d moved = track.velocity * std::min(time_s - track.time, 1.0);
  return track.box + cv::Point(cvRound(moved.x), cvRound(moved.y));
}

/// Searches a part of the image for a face of about the right size. The steps from size to size are smaller than in a
/// search of the whole image, so that what that has seen is not lost by chance.
std::optional<FoundFace> findNear(const FaceTrack& track, const cv::Rect& part, const cv::Mat& gray, FaceSearch& search,
                                  const FaceParams& params)
{
  const int side = track.box.width;
  FaceWindows windows = FaceWindows::of(params).narrowed(cvRound(kMinSizeRatio * side), cvRound(kMaxSizeRatio * side));
  windows.scale_factor = std::min(kNearScaleFactor, params.scale_factor);
  std::vector<FaceView> views = search.views();
  std::stable_partition(views.begin(), views.end(), [&](FaceView view) { return view == track.view; });
  for (const FaceView view : views)
  {
    const auto found = search.find(view, gray, part, windows);
    if (found.empty()) continue;
    return *std::max_element(found.begin(), found.end(),
                             [](const FoundFace& a, const FoundFace& b) { return a.neighbors < b.neighbors; });
  }
  return std::nullopt;
}

void move(FaceTrack& track, double time_s, const cv::Rect& box)
{
  const double seconds = time_s - track.time;
  if (seconds > kMinFramePeriod)
    track.velocity += kVelocityGain * ((middle(box) - middle(track.box)) / seconds - track.velocity);
  track.box = box;
  track.time = time_s;
  track.past.emplace_back(time_s, box);
  if (track.past.size() > kMaxHistory) track.past.pop_front();
}

void see(FaceTrack& track, double time_s, const FoundFace& face)
{
  move(track, time_s, face.box);
  track.view = face.view;
  track.seen = time_s;
  track.visible = true;
  track.predicted = false;
  track.score = scoreOf(face.neighbors);
}

cv::Mat templateOf(const cv::Mat& gray, const cv::Rect& box)
{
  cv::Mat pixels;
  cv::resize(gray(box), pixels, {kTemplateSide, kTemplateSide}, 0.0, 0.0, cv::INTER_AREA);
  return pixels;
}

/// Where the image correlates best with a template, up to `margin` px away from `expected`, and the correlation (-1 to
/// 1).
std::optional<std::pair<cv::Rect, double>> locate(const cv::Mat& appearance, const cv::Mat& gray,
                                                  const cv::Rect& expected, int margin)
{
  const cv::Rect part = grown(expected, margin, gray.size());
  const double scale = static_cast<double>(kTemplateSide) / expected.width;
  const cv::Size size(cvRound(part.width * scale), cvRound(part.height * scale));
  if (size.width < kTemplateSide || size.height < kTemplateSide) return std::nullopt;
  cv::Mat pixels, correlation;
  cv::resize(gray(part), pixels, size, 0.0, 0.0, cv::INTER_AREA);
  cv::matchTemplate(pixels, appearance, correlation, cv::TM_CCOEFF_NORMED);
  double best = 0.0;
  cv::Point where;
  cv::minMaxLoc(correlation, nullptr, &best, nullptr, &where);
  const cv::Point corner = part.tl() + cv::Point(cvRound(where.x / scale), cvRound(where.y / scale));
  return std::make_pair(cv::Rect({std::clamp(corner.x, 0, gray.cols - expected.width),
                                  std::clamp(corner.y, 0, gray.rows - expected.height)},
                                 expected.size()),
                        best);
}

/// Whether the face would have been found with the larger steps of a search of the whole image, too, in which fewer
/// windows can agree on it.
bool isSure(const FoundFace& face, const FaceParams& params)
{
  return face.neighbors >
         params.min_neighbors * std::max(std::log(params.scale_factor) / std::log(kNearScaleFactor), 1.0);
}

}  // namespace

double scoreOf(int neighbors)
{
  return neighbors / (neighbors + 4.0);
}

void FaceTracks::follow(double time_s, const cv::Mat& gray, FaceSearch& search, const FaceParams& params)
{
  for (FaceTrack& track : tracks_)
  {
    if (!track.visible) continue;
    if (time_s - track.time > kMaxAbsence) track.id = -1;  // there may be another face in its place
    const cv::Rect expected = expectedBox(track, time_s);
    const int margin = cvRound(uncertainty(time_s - track.time) * track.box.width);
    const auto found = findNear(track, grown(expected, margin, gray.size()), gray, search, params);
    const bool sure = found && isSure(*found, params);
    // A face is missed once while no cascade sees it: `hold` says for how long, at any frame rate.
    if (found || !track.predicted) track.trust = std::min(track.trust + (sure ? 1 : -kMissWeight), kMaxTrust);
    track.visible = track.trust > 0;
    if (!track.visible) continue;
    if (found)
    {
      see(track, time_s, *found);
      if (!sure) continue;
      track.appearance = templateOf(gray, found->box);
      if (track.id < 0) track.id = next_id_++;
      continue;
    }
    const auto located = locate(track.appearance, gray, expected, margin);
    const double hold = params.hold * std::min(track.trust, kTrustToHold) / kTrustToHold;
    track.visible = located && located->second >= kMinCorrelation && time_s - track.seen <= hold;
    if (!track.visible) continue;
    move(track, time_s, located->first);
    track.predicted = true;
    track.score = located->second;
  }
  dropDoubles();
  const auto forgotten = [&](const FaceTrack& track)
  { return !track.visible && (track.id < 0 || time_s - track.seen > kMaxAbsence); };
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), forgotten), tracks_.end());
}

void FaceTracks::add(const FaceResult& result, double time_s, const FaceParams& params)
{
  const double time = result.job.time;
  for (const FoundFace& face : result.found)
  {
    if (!FaceWindows::of(params).admit(face.box.width)) continue;  // it was searched for with other parameters
    const auto known = std::find_if(tracks_.begin(), tracks_.end(),
                                    [&](const FaceTrack& track) { return isSame(boxAt(track, time), face.box); });
    if (known != tracks_.end() && known->visible)
    {
      known->seen = std::max(known->seen, time);
      continue;
    }
    FaceTrack track = known != tracks_.end() ? *known : FaceTrack{};
    track.velocity = {};
    track.trust = kMissWeight + 1;  // so that it lasts if it is not seen at once
    track.time = time;
    see(track, time, face);
    track.appearance = templateOf(result.job.gray, face.box);
    if (time == time_s && track.id < 0) track.id = next_id_++;
    if (known != tracks_.end())
      *known = track;
    else
      tracks_.push_back(track);
  }
}

std::vector<Face> FaceTracks::faces() const
{
  std::vector<Face> faces;
  for (const FaceTrack& track : tracks_)
    if (track.visible && track.id >= 0)
      faces.push_back({track.id, track.box, track.score, track.velocity, track.predicted});
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.id < b.id; });
  return faces;
}

std::vector<cv::Rect> FaceTracks::boxes() const
{
  std::vector<cv::Rect> boxes;
  for (const FaceTrack& track : tracks_)
    if (track.visible) boxes.push_back(track.box);
  return boxes;
}

FaceWindows FaceTracks::windows(const FaceParams& params) const
{
  const FaceWindows all = FaceWindows::of(params);
  if (tracks_.empty()) return all;
  const auto [smallest, largest] = std::minmax_element(
      tracks_.begin(), tracks_.end(), [](const FaceTrack& a, const FaceTrack& b) { return a.box.width < b.box.width; });
  return all.narrowed(smallest->box.width / 2, 2 * largest->box.width);
}

void FaceTracks::keep(const FaceWindows& windows)
{
  const auto is_other = [&](const FaceTrack& track) { return !windows.admit(track.box.width); };
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), is_other), tracks_.end());
}

/// Where two tracks have come to follow the same face, keeps the one that is trusted more, or the older one.
void FaceTracks::dropDoubles()
{
  std::stable_sort(tracks_.begin(), tracks_.end(),
                   [](const FaceTrack& a, const FaceTrack& b) { return a.trust > b.trust; });
  for (std::size_t i = 0; i < tracks_.size(); ++i)
  {
    if (!tracks_[i].visible) continue;
    const auto same = [&](const FaceTrack& other) { return other.visible && isSame(tracks_[i].box, other.box); };
    const auto next = tracks_.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    tracks_.erase(std::remove_if(next, tracks_.end(), same), tracks_.end());
  }
}

}  // namespace robot_vision
