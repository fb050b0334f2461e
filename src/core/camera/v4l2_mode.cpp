#include "v4l2_mode.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "robot_vision/common/range.hpp"
#include "v4l2_formats.hpp"

namespace robot_vision
{
namespace
{

constexpr double kRateTolerance = 0.005;  // relative: 29.97 Hz count as 30 Hz

struct Candidate
{
  const V4l2Format* format;
  cv::Size size;
};

/// Asks the driver to set a format. It may choose another size and even another pixel format, which the result tells;
/// the result is empty if we cannot use that pixel format.
std::optional<V4l2Mode> trySetFormat(V4l2Device& device, const Candidate& wanted)
{
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<std::uint32_t>(wanted.size.width);
  format.fmt.pix.height = static_cast<std::uint32_t>(wanted.size.height);
  format.fmt.pix.pixelformat = wanted.format->fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const int error = device.tryCall(VIDIOC_S_FMT, &format);
  if (error == EINVAL) return std::nullopt;
  if (error != 0) device.fail("VIDIOC_S_FMT", error);
  V4l2Mode mode;
  mode.pixels = format.fmt.pix;
  const bool same = mode.pixels.pixelformat == wanted.format->fourcc;
  mode.format = same ? wanted.format : findV4l2Format(mode.pixels.pixelformat);
  if (mode.format == nullptr) return std::nullopt;
  return mode;
}

bool matches(const V4l2Mode& mode, const Candidate& wanted)
{
  return mode.format == wanted.format && static_cast<int>(mode.pixels.width) == wanted.size.width &&
         static_cast<int>(mode.pixels.height) == wanted.size.height;
}

const V4l2Offer* findOffer(const std::vector<V4l2Offer>& offers, std::uint32_t fourcc)
{
  const auto found =
      std::find_if(offers.begin(), offers.end(), [fourcc](const V4l2Offer& offer) { return offer.fourcc == fourcc; });
  return found == offers.end() ? nullptr : &*found;
}

/// The formats to try, the best first.
std::vector<Candidate> candidates(const std::vector<V4l2Offer>& offers, const Candidate& wanted)
{
  std::vector<Candidate> found;
  for (const V4l2Format& format : kV4l2Formats)
  {
    const V4l2Offer* offer = findOffer(offers, format.fourcc);
    if (offer == nullptr && !offers.empty()) continue;
    const bool has_sizes = offer != nullptr && !offer->sizes.empty();
    found.push_back({&format, has_sizes ? nearestSize(offer->sizes, wanted.size) : wanted.size});
  }
  const auto key = [&wanted](const Candidate& candidate)
  {
    const cv::Size difference = candidate.size - wanted.size;
    return std::pair(candidate.format != wanted.format, std::abs(difference.width) + std::abs(difference.height));
  };
  std::stable_sort(found.begin(), found.end(),
                   [&key](const Candidate& a, const Candidate& b) { return key(a) < key(b); });
  return found;
}

/// "; it offers YUYV, MJPG: 320x240, 640x480; NV12: 16x16 to 640x480", without the formats that we cannot use.
std::string describeOffers(const std::vector<V4l2Offer>& offers)
{
  std::vector<std::pair<std::string, std::string>> groups;  // formats and their common sizes
  for (const V4l2Offer& offer : offers)
  {
    if (findV4l2Format(offer.fourcc) == nullptr) continue;
    const std::string sizes = describeSizes(offer.sizes);
    const auto same =
        std::find_if(groups.begin(), groups.end(), [&sizes](const auto& group) { return group.second == sizes; });
    if (same == groups.end())
      groups.emplace_back(fourccText(offer.fourcc), sizes);
    else
      same->first += ", " + fourccText(offer.fourcc);
  }
  std::string text;
  for (const auto& [formats, sizes] : groups)
    text += (text.empty() ? "; it offers " : "; ") + formats + (sizes.empty() ? "" : ": " + sizes);
  return text;
}

[[noreturn]] void refuse(V4l2Device& device, const std::vector<V4l2Offer>& offers)
{
  std::vector<std::string> offered;
  for (const V4l2Offer& offer : offers)
    offered.push_back(fourccText(offer.fourcc));
  throw SourceUnavailable(device.path() + ": " + (offered.empty() ? "gives" : "offers " + joined(offered) + ", but") +
                          " none of " + v4l2FormatNames());
}

V4l2Mode negotiatePixelFormat(V4l2Device& device, const Candidate& wanted)
{
  // Listing what the driver offers takes some hundred calls, so it is only done when it is needed.
  if (const auto first = trySetFormat(device, wanted); first && matches(*first, wanted)) return *first;
  const std::vector<V4l2Offer> offers = offeredFormats(device);
  for (const Candidate& candidate : candidates(offers, wanted))
  {
    std::optional<V4l2Mode> mode = trySetFormat(device, candidate);
    if (!mode) continue;
    if (!matches(*mode, wanted))
      mode->warning = "asked for " + describeFormat(wanted.format->fourcc, wanted.size.width, wanted.size.height) +
                      ", gives " + describe(*mode) + describeOffers(offers);
    return *mode;
  }
  refuse(device, offers);
}

/// Says how images made of fields differ from full frames; empty if they are full frames.
std::string describeFields(std::uint32_t field)
{
  switch (field)
  {
    case V4L2_FIELD_TOP:
    case V4L2_FIELD_BOTTOM:
    case V4L2_FIELD_ALTERNATE:
      return "its images are single fields";
    case V4L2_FIELD_SEQ_TB:
    case V4L2_FIELD_SEQ_BT:
      return "its images are two fields, one below the other";
    case V4L2_FIELD_INTERLACED:
    case V4L2_FIELD_INTERLACED_TB:
    case V4L2_FIELD_INTERLACED_BT:
      return "its images are interlaced: what moves has combed edges";
    default:
      return "";
  }
}

void addWarning(V4l2Mode& mode, const std::string& text)
{
  mode.warning += (mode.warning.empty() ? "" : "; ") + text;
}

/// Sets the frame rate. A driver need not support that.
void negotiateRate(V4l2Device& device, const CaptureParams& params, V4l2Mode& mode)
{
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device.tryCall(VIDIOC_G_PARM, &parameters) != 0) return;
  v4l2_fract& period = parameters.parm.capture.timeperframe;
  const double rate = wantedRate(params);
  const cv::Size size(static_cast<int>(mode.pixels.width), static_cast<int>(mode.pixels.height));
  const std::vector<V4l2Periods> offered = offeredPeriods(device, mode.pixels.pixelformat, size);
  if ((parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0)
  {
    period = offered.empty() ? periodOf(rate) : nearestPeriod(offered, rate);
    if (device.tryCall(VIDIOC_S_PARM, &parameters) != 0) device.tryCall(VIDIOC_G_PARM, &parameters);
  }
  mode.rate = rateOf(period);
  if (params.framerate > 0.0 && mode.rate > 0.0 && std::abs(mode.rate - rate) > kRateTolerance * rate)
    addWarning(mode, "asked for " + toText(rate) + " Hz, gives " + rateText(mode.rate) +
                         (offered.empty() ? "" : "; " + describe(mode) + " has " + describeRates(offered)));
}

}  // namespace

V4l2Mode negotiateFormat(V4l2Device& device, const CaptureParams& params)
{
  const Candidate wanted = {findV4l2Format(params.pixel_format), {params.image_width, params.image_height}};
  V4l2Mode mode = negotiatePixelFormat(device, wanted);
  if (const std::string fields = describeFields(mode.pixels.field); !fields.empty()) addWarning(mode, fields);
  negotiateRate(device, params, mode);
  return mode;
}

std::string describe(const V4l2Mode& mode)
{
  return describeFormat(mode.pixels.pixelformat, mode.pixels.width, mode.pixels.height);
}

}  // namespace robot_vision
