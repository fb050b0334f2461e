#include "v4l2_formats.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

/// Makes an enumerating call with index 0, 1, ... until the driver has no more answers.
template <class Question, class Take>
void enumerate(V4l2Device& device, unsigned long request, Question question, Take take)
{
  for (question.index = 0; question.index < kMaxEntries; ++question.index)
  {
    Question answer = question;
    if (device.tryCall(request, &answer) != 0) return;
    take(answer);
  }
}

v4l2_frmsize_stepwise toRange(const v4l2_frmsizeenum& answer)
{
  if (answer.type != V4L2_FRMSIZE_TYPE_DISCRETE) return answer.stepwise;
  const v4l2_frmsize_discrete& size = answer.discrete;
  return {size.width, size.width, 1, size.height, size.height, 1};
}

V4l2Periods toRange(const v4l2_frmivalenum& answer)
{
  if (answer.type != V4L2_FRMIVAL_TYPE_DISCRETE) return {answer.stepwise.min, answer.stepwise.max};
  return {answer.discrete, answer.discrete};
}

std::vector<v4l2_frmsize_stepwise> offeredSizes(V4l2Device& device, std::uint32_t fourcc)
{
  std::vector<v4l2_frmsize_stepwise> sizes;
  v4l2_frmsizeenum question{};
  question.pixel_format = fourcc;
  enumerate(device, VIDIOC_ENUM_FRAMESIZES, question,
            [&sizes](const v4l2_frmsizeenum& answer) { sizes.push_back(toRange(answer)); });
  return sizes;
}

/// The number nearest to `wanted` among low, low + step, ... high.
int nearest(std::uint32_t low, std::uint32_t high, std::uint32_t step, int wanted)
{
  if (wanted <= static_cast<int>(low)) return static_cast<int>(low);
  const std::uint32_t steps = (static_cast<std::uint32_t>(wanted) - low + step / 2) / std::max(step, 1U);
  return static_cast<int>(std::min(high, low + steps * step));
}

double rateDifference(double rate, const v4l2_fract& period)
{
  return std::abs(rateOf(period) - rate);
}

}  // namespace

std::vector<V4l2Offer> offeredFormats(V4l2Device& device)
{
  std::vector<V4l2Offer> offers;
  v4l2_fmtdesc question{};
  question.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  enumerate(device, VIDIOC_ENUM_FMT, question,
            [&offers](const v4l2_fmtdesc& answer) {
              offers.push_back({answer.pixelformat, textOf(answer.description)});
            });
  for (V4l2Offer& offer : offers)
    offer.sizes = offeredSizes(device, offer.fourcc);
  return offers;
}

std::vector<V4l2Periods> offeredPeriods(V4l2Device& device, std::uint32_t fourcc, cv::Size size)
{
  std::vector<V4l2Periods> periods;
  v4l2_frmivalenum question{};
  question.pixel_format = fourcc;
  question.width = static_cast<std::uint32_t>(size.width);
  question.height = static_cast<std::uint32_t>(size.height);
  enumerate(device, VIDIOC_ENUM_FRAMEINTERVALS, question,
            [&periods](const v4l2_frmivalenum& answer) { periods.push_back(toRange(answer)); });
  return periods;
}

cv::Size nearestSize(const std::vector<v4l2_frmsize_stepwise>& sizes, cv::Size wanted)
{
  const auto nearest_in = [wanted](const v4l2_frmsize_stepwise& range)
  {
    return cv::Size(nearest(range.min_width, range.max_width, range.step_width, wanted.width),
                    nearest(range.min_height, range.max_height, range.step_height, wanted.height));
  };
  const auto distance_of = [wanted](cv::Size size)
  { return std::abs(size.width - wanted.width) + std::abs(size.height - wanted.height); };
  cv::Size best = nearest_in(sizes.front());
  for (const v4l2_frmsize_stepwise& range : sizes)
    if (const cv::Size size = nearest_in(range); distance_of(size) < distance_of(best)) best = size;
  return best;
}

v4l2_fract nearestPeriod(const std::vector<V4l2Periods>& periods, double rate)
{
  v4l2_fract best = periods.front().shortest;
  for (const V4l2Periods& offered : periods)
  {
    if (rateOf(offered.longest) < rate && rate < rateOf(offered.shortest)) return periodOf(rate);
    for (const v4l2_fract& end : {offered.shortest, offered.longest})
      if (rateDifference(rate, end) < rateDifference(rate, best)) best = end;
  }
  return best;
}

double rateOf(const v4l2_fract& period)
{
  return period.numerator == 0 ? 0.0 : static_cast<double>(period.denominator) / period.numerator;
}

v4l2_fract periodOf(double rate)
{
  constexpr double kMaxMs = 4e9;  // fits in 32 bits
  if (rate >= 1.0) return {1000, static_cast<std::uint32_t>(std::lround(rate * 1000.0))};
  return {static_cast<std::uint32_t>(std::lround(std::min(1000.0 / rate, kMaxMs))), 1000};
}

std::string rateText(double rate)
{
  const double digits = rate >= 1.0 ? 2.0 : 2.0 - std::floor(std::log10(rate));
  const double scale = rate > 0.0 ? std::pow(10.0, digits) : 1.0;
  return toText(std::round(rate * scale) / scale);
}

std::string describeSizes(const std::vector<v4l2_frmsize_stepwise>& sizes)
{
  std::string text;
  for (const v4l2_frmsize_stepwise& range : sizes)
  {
    text += (text.empty() ? "" : ", ") + sizeText(range.min_width, range.min_height);
    if (range.min_width == range.max_width && range.min_height == range.max_height) continue;
    text += " to " + sizeText(range.max_width, range.max_height);
    if (range.step_width > 1 || range.step_height > 1)
      text += " in steps of " + sizeText(range.step_width, range.step_height);
  }
  return text;
}

std::string describeRates(const std::vector<V4l2Periods>& periods)
{
  const auto rate = [](const v4l2_fract& period) { return rateText(rateOf(period)); };
  std::string text;
  for (const V4l2Periods& offered : periods)
  {
    const std::string low = rate(offered.longest);
    const std::string high = rate(offered.shortest);
    text += (text.empty() ? "" : ", ") + (low == high ? low : low + " to " + high);
  }
  return text + " Hz";
}

}  // namespace robot_vision
