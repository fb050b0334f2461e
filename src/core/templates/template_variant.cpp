#include "template_variant.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"
#include "template_methods.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxPeaks = 2000;  // of a variant

bool hasMean(const std::string& method)
{
  return method == "ccoeff" || method == "ccoeff_normed";
}

/// From the middle of three values to the top of the parabola through them.
double topOf(double before, double middle, double after)
{
  const double curvature = before - 2.0 * middle + after;
  return std::abs(curvature) > 0.0 ? std::clamp(0.5 * (before - after) / curvature, -0.5, 0.5) : 0.0;
}

cv::Point2d topOf(const cv::Mat_<float>& response, const cv::Point& at)
{
  const cv::Point right(1, 0), below(0, 1);
  cv::Point2d top;
  if (at.x > 0 && at.x < response.cols - 1) top.x = topOf(response(at - right), response(at), response(at + right));
  if (at.y > 0 && at.y < response.rows - 1) top.y = topOf(response(at - below), response(at), response(at + below));
  return top;
}

/// How far to the left and right of a box others of its size overlap it too much, by how much lower or higher they are,
/// px; -1: none does.
std::vector<int> overlappingColumns(const cv::Size& box, double overlap)
{
  const double most = 2.0 * box.area() * overlap / (1.0 + overlap);  // px^2 that they may share
  std::vector<int> columns;
  for (int rows = box.height; rows > 0; --rows)
    columns.push_back(std::max(cvCeil(box.width - most / rows) - 1, -1));
  return columns;
}

/// The first kMaxPeaks that do not overlap a better one too much. Without this the first rows of a flat part of the
/// image, where each place is a peak, would leave no room for those of other parts.
std::vector<TemplatePeak> bestApart(const std::vector<TemplatePeak>& sorted, const cv::Size& places,
                                    const cv::Size& box, double overlap)
{
  const std::vector<int> columns = overlappingColumns(box, overlap);
  const int rows = static_cast<int>(columns.size()) - 1;
  cv::Mat_<std::uint8_t> is_near = cv::Mat::zeros(places, CV_8UC1);
  std::vector<TemplatePeak> apart;
  for (const TemplatePeak& peak : sorted)
  {
    if (is_near(peak.place) != 0) continue;
    if (apart.size() == kMaxPeaks) break;
    apart.push_back(peak);
    for (int y = std::max(peak.place.y - rows, 0); y <= std::min(peak.place.y + rows, places.height - 1); ++y)
    {
      const int reach = columns[static_cast<std::size_t>(std::abs(y - peak.place.y))];
      const cv::Range near(std::max(peak.place.x - reach, 0), std::min(peak.place.x + reach + 1, places.width));
      if (near.start < near.end) is_near.row(y).colRange(near).setTo(1);
    }
  }
  return apart;
}

/// Sets what scores and checks need: sums over the pixels that count.
void measure(TemplateVariant& variant, const std::string& method)
{
  const int channels = variant.pixels.channels();
  cv::Scalar mean, deviation;
  cv::meanStdDev(variant.pixels, mean, deviation, variant.mask);
  const double pixels = variant.mask.empty() ? static_cast<double>(variant.pixels.total())
                                             : static_cast<double>(cv::countNonZero(variant.mask));
  variant.values = pixels * channels;
  if (!hasMean(method))
  {
    variant.contrast = std::sqrt((deviation.dot(deviation) + mean.dot(mean)) / channels);
    variant.largest = 255.0 * pixels * (mean[0] + mean[1] + mean[2]);
    return;
  }
  variant.contrast = std::sqrt(deviation.dot(deviation) / channels);
  cv::Mat above;  // where the template is lighter than its mean an image can be white, and black elsewhere
  variant.pixels.convertTo(above, CV_32F);
  cv::subtract(above, mean, above);
  above = cv::max(above, 0.0);
  const cv::Scalar sum = cv::mean(above, variant.mask) * pixels;
  variant.largest = 255.0 * (sum[0] + sum[1] + sum[2]);
}

cv::Mat resized(const cv::Mat& image, const cv::Size& size, int interpolation)
{
  if (image.empty() || image.size() == size) return image.clone();
  cv::Mat out;
  cv::resize(image, out, size, 0.0, 0.0, interpolation);
  return out;
}

}  // namespace

bool isBetter(const TemplatePeak& a, const TemplatePeak& b)
{
  return std::make_tuple(-a.score, a.variant, a.place.y, a.place.x) <
         std::make_tuple(-b.score, b.variant, b.place.y, b.place.x);
}

double TemplateVariant::score(double response, const std::string& method) const
{
  double score = response;
  if (method == "sqdiff") score = 1.0 - std::sqrt(std::max(response, 0.0) / values) / 255.0;
  if (method == "sqdiff_normed") score = 1.0 - response;
  if (method == "ccorr" || method == "ccoeff") score = response / largest;
  return std::clamp(score, 0.0, 1.0);
}

std::vector<TemplatePeak> TemplateVariant::peaks(const cv::Mat_<float>& response, std::size_t number,
                                                 const TemplateParams& params) const
{
  cv::Mat_<float> best;
  if (isBestSmall(params.method))
    cv::erode(response, best, cv::Mat());
  else
    cv::dilate(response, best, cv::Mat());
  std::vector<TemplatePeak> found;
  for (int y = 0; y < response.rows; ++y)
    for (int x = 0; x < response.cols; ++x)
    {
      if (response(y, x) != best(y, x)) continue;
      const double value = score(response(y, x), params.method);
      if (value >= params.threshold) found.push_back({value, number, {x, y}, {}});
    }
  std::sort(found.begin(), found.end(), isBetter);
  if (found.size() > kMaxPeaks) found = bestApart(found, response.size(), pixels.size(), params.overlap);
  for (TemplatePeak& peak : found)
    peak.offset = topOf(response, peak.place);
  return found;
}

std::vector<double> scalesOf(const TemplateParams& params)
{
  std::vector<double> scales = {params.min_scale};
  const double ratio = params.max_scale / params.min_scale;
  for (int step = 1; step < params.scale_steps; ++step)
    scales.push_back(params.min_scale * std::pow(ratio, step / (params.scale_steps - 1.0)));
  return scales;
}

std::vector<TemplateVariant> templateVariants(int index, const cv::Mat& pixels, const cv::Mat& mask,
                                              const TemplateParams& params)
{
  std::vector<TemplateVariant> variants;
  double most_contrast = 0.0;
  for (const double scale : scalesOf(params))
  {
    TemplateVariant variant;
    variant.index = index;
    variant.scale = scale;
    const cv::Size size = scaledSize(pixels.size(), scale);
    variant.pixels = resized(pixels, size, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
    variant.mask = resized(mask, size, cv::INTER_NEAREST);
    if (!mask.empty() && cv::countNonZero(variant.mask) == 0) continue;
    measure(variant, params.method);
    most_contrast = std::max(most_contrast, variant.contrast);
    if (params.method == "sqdiff" || variant.contrast >= kMinContrast) variants.push_back(variant);
  }
  const char* what = hasMean(params.method) ? "the template's standard deviation" : "the template's root mean square";
  require(!variants.empty(), what, most_contrast,
          "at least " + toText(kMinContrast) + " gray level for " + params.method);
  return variants;
}

}  // namespace robot_vision
