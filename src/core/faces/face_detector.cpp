#include "robot_vision/faces/face_detector.hpp"

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>

#include "changed_cells.hpp"
#include "core/common/background_task.hpp"
#include "core/image/histogram_equalization.hpp"
#include "core/image/rects.hpp"
#include "eye_search.hpp"
#include "face_search.hpp"
#include "face_tracks.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kCellSide = 8;                // px, of the cells that show where something moves
constexpr double kMaxPartsArea = 0.3;       // of the image: if more has changed, its parts are not searched
constexpr double kPauseRatio = 4.0;         // durations of the last search that pass until parts are searched again
constexpr double kMinPause = 0.1;           // s that pass until then at least
constexpr double kMinPeriodOfPause = 0.1;   // s between two frames from which on it may be a pause of the stream
constexpr double kMinRatioOfPause = 2.0;    // of that time to the one before, from which on it is a pause
constexpr double kSearchTimeMargin = 1.25;  // times the duration of the last search that the next one may take

}  // namespace

void validate(const FaceParams& params)
{
  require(!params.cascade_1.empty(), "cascade_1", "''", "the name of a file");
  checkFields(params);
  require(params.max_size == 0 || params.max_size >= params.min_size, "max_size", params.max_size,
          "0 (any) or from min_size (" + toText(params.min_size) + ") to 8192");
}

struct FaceDetector::Impl
{
  explicit Impl(const FaceParams& p) : params((validate(p), p)), near(p), whole(p)
  {
    if (!p.eye_cascade.empty()) eyes = Cascade("eye_cascade", p.eye_cascade);
  }
  ~Impl() { stop = true; }  // so that there is little to wait for

  /// Whether the cascades that have been read, and the thread, are those of the parameters.
  bool reads(const FaceParams& p) const
  {
    return p.cascade_1 == params.cascade_1 && p.cascade_2 == params.cascade_2 && p.eye_cascade == params.eye_cascade &&
           p.background == params.background;
  }

  /// Takes over parameters for which reads() is true, or for which this was made.
  void configure(const FaceParams& p)
  {
    params = p;
    tracks.keep(FaceWindows::of(p));
    searched.reset();
  }

  std::vector<Face> detect(const cv::Mat& image, const std::string& encoding)
  {
    prepare(image, encoding);
    std::vector<Face> faces;
    for (const FoundFace& found : near.find(gray, fullRect(gray), FaceWindows::of(params)))
      faces.push_back({-1, found.box, scoreOf(found.neighbors), {}, false});
    return faces;
  }

  std::vector<Face> update(double time_s, const cv::Mat& image, const std::string& encoding)
  {
    requireFinite("time_s", time_s);
    const cv::Mat plain = prepare(image, encoding);
    begin(time_s);
    moving.update(plain);  // equalized, all of the image changes when something bright comes in
    takeResult();
    tracks.follow(time, gray, near, params);
    search();
    return tracks.faces();
  }

  /// Sets `gray`. Returns the gray image before its equalization, which may share the input's pixels.
  cv::Mat prepare(const cv::Mat& image, const std::string& encoding)
  {
    cv::Mat plain;
    if (params.equalize)
    {
      toEqualizedGray(image, encoding, plain, gray);
    }
    else
    {
      toGray(image, encoding, plain);
      plain.copyTo(gray);
    }
    return plain;
  }

  /// Begins a frame, and forgets all faces if it is of another size or earlier than the last one.
  void begin(double time_s)
  {
    if (gray.size() != size || time_s < time)
    {
      tracks.clear();
      searched.reset();
      rest_until = 0.0;
      search_time = 0.0;
      since_search = 0.0;
      period = 0.0;
    }
    else
    {
      const double last_period = std::exchange(period, time_s - time);
      since_search += std::min(period, std::max(kMinRatioOfPause * last_period, kMinPeriodOfPause));
    }
    size = gray.size();
    time = time_s;
  }

  /// Follows the faces that a search has found, if it has ended.
  void takeResult()
  {
    const std::optional<FaceResult> result =
        found_at_once ? std::exchange(found_at_once, std::nullopt) : background.take();
    if (!result || result->job.gray.size() != gray.size() || result->job.time > time) return;
    if (result->job.is_whole) search_time = since_search;
    rest_until = time + std::max(kPauseRatio * since_search, kMinPause);
    tracks.add(*result, time, params);
  }

  /// Begins to search what is due in this frame, unless a search is under way.
  void search()
  {
    if (background.busy()) return;
    FaceJob job = chooseJob();
    if (job.parts.empty()) return;
    job.gray = gray.clone();
    since_search = 0.0;
    if (!params.background || !background.start([this, job] { return whole.find(job, stop); }))
      found_at_once = whole.find(std::move(job), stop);
    if (!params.background) takeResult();
  }

  /// The whole image if that is due, or else where something moves.
  FaceJob chooseJob()
  {
    FaceJob job;
    job.time = time;
    const double pause = std::max(params.max_search_period - kSearchTimeMargin * search_time, 0.0);
    job.is_whole = !searched || time - *searched >= pause;
    if (job.is_whole)
    {
      searched = time;
      moving.clear();
      job.parts = {fullRect(gray)};
      job.windows = FaceWindows::of(params);
    }
    else if (time >= rest_until)
    {
      job.parts = chooseParts();
      job.windows = tracks.windows(params);
    }
    return job;
  }

  /// The parts of the image where something moves that is no known face; none if they are too large together.
  std::vector<cv::Rect> chooseParts()
  {
    for (const cv::Rect& box : tracks.boxes())
      moving.ignore(grown(box, box.width / 2, gray.size()));
    const std::vector<cv::Rect> parts = moving.take(params.min_size);
    double area = 0.0;
    for (const cv::Rect& part : parts)
      area += part.area();
    return area > kMaxPartsArea * static_cast<double>(gray.total()) ? std::vector<cv::Rect>() : parts;
  }

  FaceParams params;
  FaceSearch near;   // around known faces
  FaceSearch whole;  // of images and their parts, in the background
  Cascade eyes;
  FaceTracks tracks;
  ChangedCells moving{kCellSide};
  cv::Mat gray;                             // the newest image
  cv::Size size;                            // px, of the frames in which faces are followed
  double time = 0.0;                        // s, of the newest frame
  double period = 0.0;                      // s between it and the one before; 0: there is none
  std::optional<double> searched;           // s, the newest frame of which the whole image was searched
  double search_time = 0.0;                 // s, that the last search of a whole image took
  double since_search = 0.0;                // s since the last search began, without pauses of the stream
  double rest_until = 0.0;                  // s, before which no parts are searched
  std::optional<FaceResult> found_at_once;  // by a search in the caller's thread
  std::atomic<bool> stop{false};            // whether the search in the background shall end early
  BackgroundTask<FaceResult> background;    // is destroyed first, as it uses `whole` and `stop`
};

FaceDetector::FaceDetector(const FaceParams& params) : impl_(std::make_unique<Impl>(params))
{
}
FaceDetector::~FaceDetector() = default;

void FaceDetector::configure(const FaceParams& params)
{
  validate(params);
  if (!impl_->reads(params))
  {
    auto next = std::make_unique<Impl>(params);
    next->tracks = std::move(impl_->tracks);
    next->gray = impl_->gray;
    next->size = impl_->size;
    next->time = impl_->time;
    impl_ = std::move(next);
  }
  impl_->configure(params);
}

std::vector<Face> FaceDetector::detect(const cv::Mat& image, const std::string& encoding)
{
  return impl_->detect(image, encoding);
}

std::vector<Face> FaceDetector::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  return impl_->update(time_s, image, encoding);
}

std::vector<cv::Rect> FaceDetector::findEyes(const Face& face)
{
  return robot_vision::findEyes(impl_->eyes, impl_->gray, face.box);
}

double FaceDetector::searchTime() const
{
  return impl_->search_time;
}

void FaceDetector::waitForSearch() const
{
  impl_->background.wait();
}

}  // namespace robot_vision
