#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "robot_vision/templates/template_matcher.hpp"
#include "template_methods.hpp"

namespace robot_vision
{
namespace
{

/// Whether this OpenCV takes a mask with the method, which is tried.
bool takesMask(int method)
{
  const cv::Mat image = (cv::Mat_<uchar>(3, 3) << 10, 80, 30, 20, 90, 40, 70, 50, 60);
  const cv::Mat templ = image(cv::Rect(1, 1, 2, 2)), mask(2, 2, CV_8UC1, cv::Scalar(255));
  cv::Mat response;
  try
  {
    cv::matchTemplate(image, templ, response, method, mask);
    return true;
  }
  catch (const cv::Exception&)
  {
    return false;
  }
}

/// The mask for each channel, which OpenCV before 4.4 asks for.
cv::Mat maskOfChannels(const cv::Mat& mask, int channels)
{
  if (channels == 1) return mask;
  cv::Mat repeated;
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(channels), mask), repeated);
  return repeated;
}

/// The image with a column more at its right, a copy of the last one, or with `black` of zeros.
cv::Mat wider(const cv::Mat& image, bool black = false)
{
  cv::Mat out;
  cv::copyMakeBorder(image, out, 0, 0, 0, 1, black ? cv::BORDER_CONSTANT : cv::BORDER_REPLICATE);
  return out;
}

/// cv::matchTemplate with a mask. For ccoeff and ccoeff_normed OpenCV, at least up to 4.8, takes a template and a
/// response of 4 rows and a column for a cv::Scalar, which is an error inside: both get a column that does not count.
cv::Mat maskedResponse(cv::Mat image, cv::Mat templ, cv::Mat mask, int method)
{
  const cv::Size scalar(1, 4);
  if (templ.size() == scalar)
  {
    image = wider(image);
    templ = wider(templ);
    mask = wider(mask, true);
  }
  const bool is_scalar = image.size() - templ.size() + cv::Size(1, 1) == scalar;
  cv::Mat response;
  cv::matchTemplate(is_scalar ? wider(image) : image, templ, response, method, mask);
  return is_scalar ? response.col(0).clone() : response;
}

/// The sum over the mask of the image's values, at every place, all channels together.
cv::Mat sumOverMask(const cv::Mat& image, const cv::Mat& mask)
{
  cv::Mat sum, floats, ones;
  image.convertTo(floats, CV_32F);
  cv::Mat(mask != 0).convertTo(ones, CV_32F, 1.0 / 255.0);
  cv::matchTemplate(floats, ones, sum, cv::TM_CCORR);
  return sum;
}

/// Where the image has less contrast within the mask, or with `black` less light, than kMinContrast.
cv::Mat emptyPlaces(const cv::Mat& image, const cv::Mat& mask, bool black)
{
  cv::Mat squares;
  image.convertTo(squares, CV_32F);
  squares = squares.mul(squares);
  const double count = cv::countNonZero(mask.reshape(1));
  cv::Mat energy = sumOverMask(squares, mask) / count;
  if (black) return energy < kMinContrast * kMinContrast;
  std::vector<cv::Mat> channels, masks;
  cv::split(image, channels);
  cv::split(mask, masks);
  for (std::size_t i = 0; i < channels.size(); ++i)
  {
    const cv::Mat sum = sumOverMask(channels[i], masks[i]);
    energy -= sum.mul(sum) / (count / static_cast<double>(channels.size()) * count);
  }
  return energy < kMinContrast * kMinContrast;
}

/// Sets the worst response where OpenCV has divided by zero, or by what was left of it.
void makeFinite(const cv::Mat& image, const cv::Mat& mask, const std::string& method, cv::Mat& response)
{
  const cv::Mat finite = cv::abs(response) <= std::numeric_limits<float>::max();  // nor is NaN
  const cv::Mat empty = emptyPlaces(image, mask, method != "ccoeff_normed");
  response.setTo(isBestSmall(method) ? 1.0 : 0.0, empty | ~finite);
}

}  // namespace

int methodNumber(const std::string& method)
{
  static const std::map<std::string, int> numbers = {
      {"sqdiff", cv::TM_SQDIFF}, {"sqdiff_normed", cv::TM_SQDIFF_NORMED},
      {"ccorr", cv::TM_CCORR},   {"ccorr_normed", cv::TM_CCORR_NORMED},
      {"ccoeff", cv::TM_CCOEFF}, {"ccoeff_normed", cv::TM_CCOEFF_NORMED},
  };
  TemplateParams params;
  params.method = method;
  validate(params);
  return numbers.at(method);
}

bool isBestSmall(const std::string& method)
{
  return method == "sqdiff" || method == "sqdiff_normed";
}

bool isNormed(const std::string& method)
{
  return method.find("_normed") != std::string::npos;
}

void requireMask(const std::string& method)
{
  static const std::vector<bool> taken = []
  {
    std::vector<bool> of_methods;
    for (int number = 0; number <= cv::TM_CCOEFF_NORMED; ++number)
      of_methods.push_back(takesMask(number));
    return of_methods;
  }();
  require(taken[static_cast<std::size_t>(methodNumber(method))], "method", method,
          std::string("sqdiff or ccorr_normed for a template with a mask in OpenCV ") + CV_VERSION);
}

cv::Mat templateResponse(const cv::Mat& image, const cv::Mat& templ, const cv::Mat& mask, const std::string& method)
{
  const int number = methodNumber(method);
  require(image.type() == CV_8UC1 || image.type() == CV_8UC3, "the image's type", describePixels(image.type()),
          describePixels(CV_8UC1) + " or " + describePixels(CV_8UC3));
  require(templ.type() == image.type(), "the template's type", describePixels(templ.type()),
          "the image's, " + describePixels(image.type()));
  require(!templ.empty() && templ.cols <= image.cols && templ.rows <= image.rows, "the template's size",
          toText(templ.size()), "at most the image's, " + toText(image.size()));
  cv::Mat response;
  if (mask.empty())
    cv::matchTemplate(image, templ, response, number);
  else
  {
    require(mask.type() == CV_8UC1 && mask.size() == templ.size(), "the mask",
            toText(mask.size()) + " of " + describePixels(mask.type()),
            toText(templ.size()) + " of " + describePixels(CV_8UC1));
    requireMask(method);
    const cv::Mat of_channels = maskOfChannels(mask, image.channels());
    response = maskedResponse(image, templ, of_channels, number);
    if (isNormed(method)) makeFinite(image, of_channels, method, response);
  }
  return response;
}

cv::Mat responseImage(const cv::Mat& response, const std::string& method)
{
  checkPixels(response, "a response", CV_32FC1);
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(response, &low, &high);
  cv::Mat image = cv::Mat::zeros(response.size(), CV_8UC1);
  if (!(high > low)) return image;
  const double factor = (isBestSmall(method) ? -255.0 : 255.0) / (high - low);
  response.convertTo(image, CV_8U, factor, -factor * (isBestSmall(method) ? high : low));
  return image;
}

}  // namespace robot_vision
