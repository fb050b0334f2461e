#include "robot_vision/histogram/histogram_plot.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/image/overlay.hpp"

namespace robot_vision
{
namespace
{

constexpr double kShade = 0.3;              // share of the brightness that the image keeps below the curves
constexpr int kLeft = 48, kRight = 16;      // px, room for the labels around the curves
constexpr int kTop = 24, kBottom = 22;      // px
constexpr int kMinWidth = 96;               // px of the curves; with less room there are no labels
constexpr int kMinHeight = 48;              // px
constexpr int kLabelGap = 16;               // px between the base lines of labels
constexpr int kGlyph = 10, kHalfGlyph = 5;  // px, width of a letter, and half of its height
constexpr int kValueTicks = 4;              // parts of the axis of values
const cv::Scalar kAxis(160, 160, 160), kGrid(80, 80, 80), kText(230, 230, 230);
const cv::Size kHueSaturationSize(360, 256);

const std::map<std::string, cv::Scalar> kColors = {
    {"blue", {255, 120, 60}},       {"green", {80, 230, 80}},        {"red", {80, 80, 255}},
    {"hue", {0, 220, 255}},         {"saturation", {255, 100, 255}}, {"value", {230, 230, 230}},
    {"lightness", {230, 230, 230}}, {"a", {255, 100, 255}},          {"b", {0, 220, 255}},
    {"luma", {230, 230, 230}},      {"cr", {80, 80, 255}},           {"cb", {255, 120, 60}},
};

cv::Scalar colorOf(const std::string& channel)
{
  const auto found = kColors.find(channel);
  return found == kColors.end() ? kText : found->second;
}

/// What a count is on the axis, 0 to 1.
double heightOf(double count, double max, bool is_log)
{
  if (max <= 0.0) return 0.0;
  return is_log ? std::log1p(count) / std::log1p(max) : count / max;
}

/// 500, 20k, 5M.
std::string shortText(double count)
{
  if (count >= 1e6) return toText(count / 1e6) + "M";
  return count >= 1e3 ? toText(count / 1e3) + "k" : toText(count);
}

/// Round numbers from 1 up to the largest count: powers of ten, or two to nine steps of 1, 2 or 5 times one.
std::vector<double> countTicks(double max, bool is_log)
{
  std::vector<double> ticks;
  if (is_log)
  {
    for (double tick = 1.0; tick <= max; tick *= 10.0)
      ticks.push_back(tick);
    return ticks;
  }
  const double power = std::pow(10.0, std::floor(std::log10(std::max(max, 1.0))));
  double step = power;
  for (const double factor : {0.5, 0.2})
    if (max < 2.0 * step) step = factor * power;
  step = std::max(step, 1.0);
  for (double tick = step; tick <= max; tick += step)
    ticks.push_back(tick);
  return ticks;
}

/// The curves of a histogram in a part of an image.
class Plot
{
public:
  Plot(cv::Mat& image, const cv::Rect& area, const std::vector<ChannelHistogram>& histogram, bool is_log)
    : image_(image), histogram_(histogram), is_log_(is_log), inner_(area)
  {
    const cv::Rect inside(area.x + kLeft, area.y + kTop, area.width - kLeft - kRight, area.height - kTop - kBottom);
    has_labels_ = inside.width >= kMinWidth && inside.height >= kMinHeight;
    if (has_labels_) inner_ = inside;
    for (const ChannelHistogram& channel : histogram)
    {
      highest_ = std::max(highest_, channel.high);
      for (const std::int32_t count : channel.counts)
        max_ = std::max(max_, static_cast<double>(count));
    }
  }

  void draw()
  {
    if (has_labels_) drawAxes();
    for (const ChannelHistogram& channel : histogram_)
      drawCurve(channel);
  }

private:
  int column(double value) const { return inner_.x + cvRound(value / highest_ * (inner_.width - 1)); }

  int row(double count) const
  {
    return inner_.y + inner_.height - 1 - cvRound(heightOf(count, max_, is_log_) * (inner_.height - 1));
  }

  void drawAxes()
  {
    const cv::Point corner(inner_.x, inner_.br().y - 1);
    int last = corner.y;
    for (const double tick : countTicks(max_, is_log_))
    {
      const int y = row(tick);
      if (last - y < kLabelGap) continue;
      last = y;
      cv::line(image_, {inner_.x, y}, {inner_.br().x - 1, y}, kGrid);
      const std::string text = shortText(tick);
      drawText(image_, text, {inner_.x - 4 - kGlyph * static_cast<int>(text.size()), y + kHalfGlyph}, kText);
    }
    for (int i = 0; i <= kValueTicks; ++i)
    {
      const double value = highest_ * i / kValueTicks;
      const std::string text = toText(value);
      const int x = column(value), width = kGlyph * static_cast<int>(text.size());
      cv::line(image_, {x, corner.y}, {x, corner.y + 4}, kAxis);
      drawText(image_, text, {std::min(x - width / 2, inner_.br().x + kRight - width), corner.y + 18}, kText);
    }
    cv::line(image_, corner, {inner_.br().x - 1, corner.y}, kAxis);
    cv::line(image_, corner, inner_.tl(), kAxis);
    int x = inner_.x;
    for (const ChannelHistogram& channel : histogram_)
    {
      drawText(image_, channel.name, {x, inner_.y - 8}, colorOf(channel.name));
      x += kGlyph * static_cast<int>(channel.name.size() + 2);
    }
  }

  void drawCurve(const ChannelHistogram& channel)
  {
    const double width = (channel.high - channel.low) / static_cast<double>(channel.counts.size());
    std::vector<cv::Point> steps;
    for (std::size_t i = 0; i < channel.counts.size(); ++i)
    {
      const int y = row(channel.counts[i]);
      steps.emplace_back(column(channel.low + width * static_cast<double>(i)), y);
      steps.emplace_back(column(channel.low + width * static_cast<double>(i + 1)), y);
    }
    cv::polylines(image_, steps, false, colorOf(channel.name), has_labels_ ? 2 : 1);
  }

  cv::Mat& image_;
  const std::vector<ChannelHistogram>& histogram_;
  bool is_log_;
  bool has_labels_ = false;
  cv::Rect inner_;        // px, of the curves
  double highest_ = 1.0;  // value at the right end of the axis
  double max_ = 0.0;      // px, the largest count
};

}  // namespace

void plotHistogram(const cv::Mat& bgr, const std::vector<ChannelHistogram>& histogram,
                   const HistogramPlotParams& params, cv::Mat& out)
{
  validate(params);
  checkPixels(bgr, "bgr8");
  const bool is_over = params.plot == "over";
  out.create(bgr.rows, is_over ? bgr.cols : 2 * bgr.cols, CV_8UC3);
  bgr.copyTo(out.colRange(0, bgr.cols));
  const cv::Rect area = is_over ? cv::Rect(0, bgr.rows / 2, bgr.cols, bgr.rows - bgr.rows / 2)
                                : cv::Rect(bgr.cols, 0, bgr.cols, bgr.rows);
  if (is_over)
    out(area).convertTo(out(area), -1, kShade);
  else
    out(area).setTo(cv::Scalar::all(0));
  Plot(out, area, histogram, params.scale == "log").draw();
}

void drawHueSaturation(const cv::Mat& histogram, const HistogramPlotParams& params, cv::Mat& out)
{
  validate(params);
  require(!histogram.empty(), "the histogram", sizeText(histogram.rows, histogram.cols) + " bins", "at least 1x1 bins");
  require(histogram.type() == CV_32FC1, "the histogram", describePixels(histogram.type()), describePixels(CV_32FC1));
  double max = 0.0;
  cv::minMaxLoc(histogram, nullptr, &max);
  const int hues = histogram.rows, saturations = histogram.cols;
  cv::Mat_<cv::Vec3b> cells(saturations, hues);
  for (int s = 0; s < saturations; ++s)
    for (int h = 0; h < hues; ++h)
    {
      const double height = heightOf(histogram.at<float>(h, s), max, params.scale == "log");
      cells(saturations - 1 - s, h) = {cv::saturate_cast<std::uint8_t>(180.0 * (h + 0.5) / hues),
                                       cv::saturate_cast<std::uint8_t>(256.0 * (s + 0.5) / saturations),
                                       cv::saturate_cast<std::uint8_t>(255.0 * height)};
    }
  cv::Mat bgr;
  cv::cvtColor(cells, bgr, cv::COLOR_HSV2BGR);
  cv::resize(bgr, out, kHueSaturationSize, 0.0, 0.0, cv::INTER_NEAREST);
}

}  // namespace robot_vision
