#include "robot_vision/templates/template_matcher.hpp"

#include <algorithm>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <set>
#include <shared_mutex>

#include "core/common/work_limit.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "template_methods.hpp"
#include "template_variant.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxVariants = 200;
constexpr double kMaxPixels = 64e6;   // of all variants
constexpr double kMaxMatched = 64e6;  // pixels of an image, in each channel and for each variant, up to 120 ns each

/// The image in what templates are compared in; it may be the image itself.
cv::Mat converted(const cv::Mat& image, const std::string& encoding, bool color)
{
  cv::Mat pixels;
  if (color)
    toBgr(image, encoding, pixels);
  else
    toGray(image, encoding, pixels);
  return pixels;
}

/// The mask as what counts; empty if all does.
cv::Mat usedMask(const cv::Mat& mask, const cv::Size& size)
{
  if (mask.empty()) return {};
  checkPixels(mask, "a mask", CV_8UC1);
  require(mask.size() == size, "the mask's size", toText(mask.size()), "the template's, " + toText(size));
  const cv::Mat used = mask >= 128;
  const int count = cv::countNonZero(used);
  require(count > 0, "the mask's number of pixels that count", count, "at least 1");
  return count < size.area() ? used : cv::Mat();
}

/// Intersection over union.
double overlapOf(const cv::Rect& a, const cv::Rect& b)
{
  const double common = (a & b).area();
  return common / (a.area() + b.area() - common);
}

TemplateMatch matchOf(const TemplatePeak& peak, const TemplateVariant& variant)
{
  const cv::Size size = variant.pixels.size();
  const cv::Point2d middle((size.width - 1) / 2.0, (size.height - 1) / 2.0);
  return {variant.index, peak.score, variant.scale, {peak.place, size}, cv::Point2d(peak.place) + peak.offset + middle};
}

/// The best peak of each template.
std::vector<TemplatePeak> bestOfEach(const std::vector<TemplatePeak>& sorted,
                                     const std::vector<TemplateVariant>& variants)
{
  std::vector<TemplatePeak> best;
  std::set<int> seen;
  for (const TemplatePeak& peak : sorted)
    if (seen.insert(variants[peak.variant].index).second) best.push_back(peak);
  return best;
}

/// The best peaks that overlap no better one too much; for single none but the best of each template.
std::vector<TemplateMatch> bestMatches(std::vector<TemplatePeak> peaks, const std::vector<TemplateVariant>& variants,
                                       const TemplateParams& params)
{
  const bool single = params.results == "single";
  std::sort(peaks.begin(), peaks.end(), isBetter);
  if (single) peaks = bestOfEach(peaks, variants);
  std::vector<TemplateMatch> matches;
  for (const TemplatePeak& peak : peaks)
  {
    if (!single && static_cast<int>(matches.size()) == params.max_results) break;
    const TemplateMatch match = matchOf(peak, variants[peak.variant]);
    const bool left_out =
        std::any_of(matches.begin(), matches.end(),
                    [&](const TemplateMatch& better) { return overlapOf(better.box, match.box) > params.overlap; });
    if (!left_out) matches.push_back(match);
  }
  return matches;
}

}  // namespace

struct TemplateMatcher::Impl
{
  void requireRoom(const cv::Size& size) const
  {
    const std::vector<double> scales = scalesOf(params);
    double pixels = 0.0;
    for (const TemplateVariant& variant : variants)
      pixels += static_cast<double>(variant.pixels.total());
    for (const double scale : scales)
      pixels += static_cast<double>(size.width) * size.height * scale * scale;
    const double number = static_cast<double>(variants.size() + scales.size());
    require(number <= kMaxVariants, "the number of templates in all scales", number, "at most " + toText(kMaxVariants));
    require(pixels <= kMaxPixels, "the number of the templates' pixels in all scales", pixels,
            "at most " + toText(kMaxPixels));
  }

  void requireTime(const cv::Mat& image) const
  {
    const auto fitting = std::count_if(variants.begin(), variants.end(),
                                       [&image](const TemplateVariant& variant) { return variant.fits(image.size()); });
    requireWork("scale_steps is " + toText(params.scale_steps) + " for " + toText(count) + " templates" +
                    (params.color ? " in color" : ""),
                static_cast<double>(fitting) * image.channels(), image.size(), kMaxMatched);
  }

  TemplateParams params;
  int count = 0;  // of templates
  std::vector<TemplateVariant> variants;
  std::shared_mutex mutex;  // guards both above
};

void validate(const TemplateParams& params)
{
  checkFields(params);
  require(params.min_scale <= params.max_scale, "min_scale", params.min_scale,
          "at most max_scale, " + toText(params.max_scale));
}

TemplateMatcher::TemplateMatcher(const TemplateParams& params) : impl_(std::make_unique<Impl>())
{
  validate(params);
  impl_->params = params;
}

TemplateMatcher::~TemplateMatcher() = default;

int TemplateMatcher::add(const cv::Mat& image, const std::string& encoding, const cv::Mat& mask)
{
  const cv::Mat pixels = converted(image, encoding, impl_->params.color);
  const cv::Mat used = usedMask(mask, pixels.size());
  if (!used.empty()) requireMask(impl_->params.method);
  const std::lock_guard<std::shared_mutex> lock(impl_->mutex);
  impl_->requireRoom(pixels.size());
  for (TemplateVariant& variant : templateVariants(impl_->count, pixels, used, impl_->params))
    impl_->variants.push_back(std::move(variant));
  return impl_->count++;
}

TemplateMatches TemplateMatcher::match(const cv::Mat& image, const std::string& encoding, bool wants_response) const
{
  const TemplateParams& params = impl_->params;
  const std::vector<TemplateVariant>& variants = impl_->variants;
  const cv::Mat pixels = converted(image, encoding, params.color);
  const std::shared_lock<std::shared_mutex> lock(impl_->mutex);
  impl_->requireTime(pixels);
  TemplateMatches found;
  std::vector<TemplatePeak> peaks;
  std::vector<bool> fits(static_cast<std::size_t>(impl_->count));
  double best = -1.0;
  for (std::size_t i = 0; i < variants.size(); ++i)
  {
    const TemplateVariant& variant = variants[i];
    if (!variant.fits(pixels.size())) continue;
    fits[static_cast<std::size_t>(variant.index)] = true;
    const cv::Mat response = templateResponse(pixels, variant.pixels, variant.mask, params.method);
    const std::vector<TemplatePeak> of_variant = variant.peaks(response, i, params);
    peaks.insert(peaks.end(), of_variant.begin(), of_variant.end());
    if (!wants_response) continue;
    double low = 0.0, high = 0.0;
    cv::minMaxLoc(response, &low, &high);
    const double score = variant.score(isBestSmall(params.method) ? low : high, params.method);
    if (score <= best) continue;
    best = score;
    found.response = response;
  }
  for (int index = 0; index < impl_->count; ++index)
    if (!fits[static_cast<std::size_t>(index)]) found.too_large.push_back(index);
  found.matches = bestMatches(std::move(peaks), variants, params);
  return found;
}

}  // namespace robot_vision
