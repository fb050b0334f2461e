#include "robot_vision/lanes/lane_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "core/common/smoothing.hpp"
#include "lane_mask.hpp"
#include "lane_model.hpp"
#include "line_fit.hpp"
#include "line_search.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kPoints = 20;         // of each curve
constexpr int kSteps = 2;           // from the last line to the one in a frame
constexpr double kMaxOffset = 0.6;  // widths from its middle, at which the robot has left a lane for the next one

using lanes::LaneModel;
using lanes::LineFit;

std::vector<cv::Point2d> inImage(const GroundView& view, const std::vector<cv::Point2d>& places)
{
  std::vector<cv::Point2d> pixels;
  for (const cv::Point2d& place : places)
    pixels.push_back(view.toImage(place));
  return pixels;
}

LaneLine lineOf(const LineFit* fit, const GroundView& view)
{
  LaneLine line;
  if (!fit) return line;
  line.found = true;
  line.confidence = fit->confidence;
  for (int i = 0; i < kPoints; ++i)
  {
    const double x = fit->from + i * fit->length() / (kPoints - 1);
    line.points.emplace_back(x, fit->y(x));
    line.from_above.push_back(view.toView(line.points.back()));
  }
  line.in_image = inImage(view, line.points);
  return line;
}

}  // namespace

void validate(const LaneParams& params)
{
  checkFields(params);
  require(params.yellow_high >= params.yellow_low, "yellow_high", params.yellow_high,
          "yellow_low or more, " + toText(params.yellow_low));
  // Otherwise all that a window holds is within the tolerance, which tells nothing.
  const double widest = params.window_width / 2.0;
  require(params.tolerance < widest, "tolerance", params.tolerance, "below half of window_width, " + toText(widest));
}

struct LaneDetector::Impl
{
  Impl(const GroundParams& g, const LaneParams& p) : ground((validate(g), g)), params((validate(p), p))
  {
    const double widest = ground.view_width / 4.0;
    const int beside = lanes::floorDistance(ground.resolution, params);
    require(beside * ground.resolution <= widest + 2.0 * ground.resolution, "line_width", params.line_width,
            "at most a quarter of view_width, " + toText(widest));
    const double length = ground.far - ground.near;
    require(params.min_length < length, "min_length", params.min_length, "below far - near, " + toText(length));
    const int rows = cvRound(length / ground.resolution) / params.windows;
    require(rows > 0, "windows", params.windows, "at most the rows of the view, far - near by resolution");
    require(params.min_rows <= rows, "min_rows", params.min_rows,
            "at most the rows of a window, far - near by resolution and windows, " + toText(rows));
  }

  Lane update(double time_s, const cv::Mat& image, const std::string& encoding, const CameraModel* camera)
  {
    cv::Mat bgr;
    toBgr(image, encoding, bgr);
    look(camera, bgr.size());
    const bool goes_on = time_s >= last_time && time_s - last_time <= params.max_gap;
    if (!goes_on) forget();
    Lane lane;
    view->fromAbove(bgr, lane.view);
    lane.mask = lanes::lineMask(lane.view, view->seen(), ground.resolution, params);
    search(time_s, lane);
    return lane;
  }

  /// Makes a new view of the ground if the camera or the image is another one.
  void look(const CameraModel* camera, const cv::Size& size)
  {
    const bool by_camera = ground.ground == "camera";
    if (by_camera) require(camera != nullptr, "the camera", "not known", "given, as ground is camera");
    const bool known = by_camera ? *camera == seen_by : size == seen_size;
    if (known && view) return;
    if (known && !refusal.empty()) throw std::invalid_argument(refusal);  // it takes long to find that out again
    forget();
    view.reset();
    refusal.clear();
    seen_size = size;
    if (by_camera) seen_by = *camera;
    try
    {
      if (by_camera)
        view.emplace(ground, *camera);
      else
        view.emplace(ground, params.lane_width, size);
    }
    catch (const std::invalid_argument& e)
    {
      refusal = e.what();
      throw;
    }
  }

  /// The lines around where they were; else, or if one of them is missing, those in the whole view, where
  /// both of the lane beside may be seen: they do not count before the robot has left its own.
  void search(double time_s, Lane& lane)
  {
    const lanes::Middles middles = lanes::middlesOf(lane.mask);
    std::vector<LineFit> fits = aroundLast(middles);
    lanes::LanePair pair = lanes::choosePair(fits, params, last);
    const bool has_left = last && std::abs(last->offset) > kMaxOffset * last->width;
    if (!pair.left || !pair.right || has_left)
    {
      fits.clear();
      const double half_width = params.window_width / ground.resolution / 2.0;
      for (const lanes::Places& line : lanes::followLines(middles, lane.mask.cols, half_width, params))
      {
        const auto fit = lanes::fitLine(line, *view, params);
        if (fit && (!last || has_left || lanes::mayBeOf(*last, *fit))) fits.push_back(*fit);
      }
      pair = lanes::choosePair(fits, params, last);
    }
    const double width = last ? last->width : params.lane_width;
    const std::optional<LaneModel> found = lanes::fitLane(pair, width, params);
    if (!found) return;
    keep(time_s, *found, pair);
    report(pair, lane);
  }

  std::vector<LineFit> aroundLast(const lanes::Middles& middles) const
  {
    std::vector<LineFit> fits;
    for (const LineFit& last : lines)
    {
      // A line that has moved far is only partly around where it was, and wholly around where it is found then.
      std::optional<LineFit> fit = last;
      for (int i = 0; i < kSteps && fit; ++i)
        fit = around(*fit, middles);
      if (fit) fits.push_back(*fit);
    }
    return fits;
  }

  std::optional<LineFit> around(const LineFit& line, const lanes::Middles& middles) const
  {
    std::vector<double> columns;
    for (std::size_t row = 0; row < middles.size(); ++row)
    {
      const double x = view->toGround({0.0, static_cast<double>(row)}).x;
      columns.push_back(view->toView({x, line.y(x)}).x);
    }
    const double half_width = params.window_width / ground.resolution / 2.0;
    return lanes::fitLine(lanes::middlesAround(middles, columns, half_width), *view, params);
  }

  /// Remembers the lane, and takes the mean with those before, unless they are of the lane beside it.
  void keep(double time_s, const LaneModel& found, const lanes::LanePair& pair)
  {
    const bool is_same = last && std::abs(found.offset - last->offset) <= last->width / 2.0;
    const double share = is_same ? smoothingGain(time_s - last_time, params.smoothing) : 1.0;
    if (!is_same) mean = found;
    for (const auto member : {&LaneModel::offset, &LaneModel::heading, &LaneModel::curvature, &LaneModel::width})
      mean.*member += share * (found.*member - mean.*member);
    last = found;
    lines.clear();
    for (const LineFit* line : {pair.left, pair.right})
      if (line) lines.push_back(*line);
    last_time = time_s;
  }

  void report(const lanes::LanePair& pair, Lane& lane) const
  {
    lane.found = true;
    lane.offset = mean.offset;
    lane.heading = mean.heading;
    lane.curvature = mean.curvature;
    lane.width = mean.width;
    lane.left = lineOf(pair.left, *view);
    lane.right = lineOf(pair.right, *view);
    for (int i = 0; i < kPoints; ++i)
      lane.middle.push_back(mean.middle(i * ground.far / (kPoints - 1)));
    lane.middle_in_image = inImage(*view, lane.middle);
  }

  void forget()
  {
    last.reset();
    lines.clear();
    last_time = -std::numeric_limits<double>::infinity();
  }

  GroundParams ground;
  LaneParams params;
  std::optional<GroundView> view;
  CameraModel seen_by;                                          // for which `view` was made or refused
  cv::Size seen_size;                                           // px, likewise with points
  std::string refusal;                                          // why there is no view for them
  std::optional<LaneModel> last;                                // the last lane as it was seen
  LaneModel mean;                                               // its mean over frames, which is behind when it moves
  std::vector<LineFit> lines;                                   // its lines
  double last_time = -std::numeric_limits<double>::infinity();  // s, when it was seen
  std::mutex mutex;                                             // guards all above; held during a call
};

LaneDetector::LaneDetector(const GroundParams& ground, const LaneParams& params)
  : impl_(std::make_unique<Impl>(ground, params))
{
}

LaneDetector::~LaneDetector() = default;

Lane LaneDetector::update(double time_s, const cv::Mat& image, const std::string& encoding, const CameraModel* camera)
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->update(time_s, image, encoding, camera);
}

void LaneDetector::reset()
{
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  impl_->forget();
}

}  // namespace robot_vision
