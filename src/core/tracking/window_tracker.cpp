#include "robot_vision/tracking/window_tracker.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "color_model.hpp"
#include "core/common/smoothing.hpp"
#include "core/image/conversion_buffer.hpp"
#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"
#include "velocity.hpp"
#include "window_fit.hpp"

namespace robot_vision
{

struct WindowTracker::Impl
{
  /// Follows the object into the newest frame, or searches for it.
  void follow(bool is_comparable)
  {
    projection = model->backProject(newest);
    is_expected = is_expected && is_comparable;
    const bool was_tracked = is_comparable && state.tracked;
    std::optional<WindowFit> fit;
    if (was_tracked) fit = fitWindow(projection, state.window, params);
    const bool is_shifted = fit.has_value();
    if (!fit)
    {
      const std::optional<cv::Rect> place = densestWindow(projection, model->size());
      if (place) fit = fitWindow(projection, *place, params);
    }
    if (fit)
      accept(*fit, is_shifted);
    else
      lose();
  }

  void accept(const WindowFit& fit, bool is_shifted)
  {
    const double elapsed = time - seen_time;
    if (!is_shifted)
      velocity = {};
    else if (elapsed >= kMinInterval)
      velocity += smoothingGain(elapsed, params.smoothing) * ((fit.center - seen.center) / elapsed - velocity);
    if (measured_by != params.method) measureAnew(fit);
    // A rectangle looks the same after half a turn: of both rotations the smaller one is meant.
    const double turned = std::remainder(fit.direction - seen.direction, CV_PI);
    state.angle = std::remainder(state.angle + turned, 2.0 * CV_PI);
    state.scale = std::sqrt(fit.area / selected_area);
    state.tracked = true;
    state.predicted = false;
    state.window = fit.window;
    state.outline = fit.outline;
    state.center = fit.center;
    state.velocity = velocity;
    state.confidence = fit.similarity;
    seen = fit;
    seen_time = time;
    is_expected = true;
  }

  /// Has the next sizes and directions compared with those of this fit: each method has its own of the same thing.
  void measureAnew(const WindowFit& fit)
  {
    measured_by = params.method;
    selected_area = fit.area / (state.scale * state.scale);
    seen.direction = fit.direction;
    state.angle = 0.0;
  }

  void lose()
  {
    const double elapsed = time - seen_time;
    state.tracked = false;
    state.confidence = 0.0;
    state.predicted = is_expected && elapsed <= params.max_prediction && params.max_prediction > 0.0;
    state.velocity = state.predicted ? velocity : cv::Point2d();
    state.center = seen.center + state.velocity * elapsed;
    for (std::size_t i = 0; i < state.outline.size(); ++i)
      state.outline[i] = seen.outline[i] + state.velocity * elapsed;
  }

  WindowTrackerParams params;
  ConversionBuffer buffer;
  cv::Mat newest;                   // CV_8UC3, BGR
  cv::Mat projection;               // CV_8UC1, of the object in the newest frame
  std::optional<ColorModel> model;  // of the object; none: there is no object
  TrackedWindow state;
  WindowFit seen;              // the last place
  double seen_time = 0.0;      // s, when it was there
  bool is_expected = false;    // whether all frames since then are of the same size and in order
  cv::Point2d velocity;        // px/s, when it was there
  std::string measured_by;     // the method that the next, and the direction there, are of
  double selected_area = 1.0;  // px^2, of the outline when it was selected
  int last_id = 0;
  double time = 0.0;  // s, of the newest frame
};

WindowTracker::WindowTracker(const WindowTrackerParams& params) : impl_(std::make_unique<Impl>())
{
  configure(params);
}

WindowTracker::~WindowTracker() = default;
WindowTracker::WindowTracker(WindowTracker&&) noexcept = default;
WindowTracker& WindowTracker::operator=(WindowTracker&&) noexcept = default;

void WindowTracker::configure(const WindowTrackerParams& params)
{
  validate(params);
  impl_->params = params;
  if (impl_->model) impl_->model->configure(params);
}

int WindowTracker::select(const cv::Rect& region, const std::string& label)
{
  Impl& me = *impl_;
  if (me.newest.empty()) throw std::invalid_argument("there is no image yet to select a region of");
  requireInside(region, me.newest.size());
  const std::string what = regionText(region);
  if (region.area() < me.params.min_area)
    throw std::invalid_argument(what + " is too small, must have at least min_area, " + toText(me.params.min_area) +
                                " px^2");
  ColorModel model(me.newest, region, me.params);
  const cv::Mat projection = model.backProject(me.newest);
  if (cv::countNonZero(projection(region)) == 0)
    throw std::invalid_argument(what +
                                " has no colour of its own: it is gray or dark (min_saturation, min_value), or "
                                "has the colours that are around it (subtract_background)");
  const std::optional<WindowFit> fit = fitWindow(projection, region, me.params);
  if (!fit)
    throw std::invalid_argument(what +
                                " cannot be followed: too little of it has its most frequent colours "
                                "(min_similarity, min_area)");
  me.model = std::move(model);
  me.projection = projection;
  me.state = TrackedWindow();
  me.state.id = ++me.last_id;
  me.state.label = label;
  me.seen = *fit;
  me.measured_by = me.params.method;
  me.selected_area = fit->area;
  me.seen_time = me.time;
  me.accept(*fit, /*is_shifted=*/false);
  return me.state.id;
}

bool WindowTracker::forget(int id)
{
  if (!impl_->model || impl_->state.id != id) return false;
  impl_->model.reset();
  impl_->projection = cv::Mat();
  return true;
}

std::vector<TrackedWindow> WindowTracker::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  Impl& me = *impl_;
  requireFinite("time_s", time_s);
  const cv::Mat bgr = me.buffer.bgr(image, encoding);
  const bool is_comparable = bgr.size() == me.newest.size() && time_s >= me.time;
  bgr.copyTo(me.newest);
  me.time = time_s;
  if (me.model) me.follow(is_comparable);
  return objects();
}

std::vector<TrackedWindow> WindowTracker::objects() const
{
  if (!impl_->model) return {};
  return {impl_->state};
}

cv::Mat WindowTracker::backProjection() const
{
  return impl_->projection;
}

}  // namespace robot_vision
