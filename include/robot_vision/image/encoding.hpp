#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// An image and its encoding.
struct EncodedImage
{
  cv::Mat pixels;
  std::string encoding;
};

/// Names of the pixel layouts that every function below accepts. bgr8, rgb8, bgra8, rgba8, mono8, mono16, bayer_*8,
/// bayer_*16, yuv422 (UYVY) and yuv422_yuy2 (YUYV) are those of sensor_msgs/image_encodings.h. The others come only
/// from cameras: mono10 (10 bits in the low end of 16), nv12, nv21 and yu12 (the luma with the chroma below it, in one
/// matrix of 3/2 of the height), and jpeg.
std::vector<std::string> encodings();

/// Whether the name is one of encodings().
bool isEncoding(const std::string& encoding);

/// Whether the name is one of encodings() that a sensor_msgs/Image can have.
bool isMessageEncoding(const std::string& encoding);

/// Whether the encoding is one of depths: 16UC1 in mm, where 0 is none, or 32FC1 in m, where NaN is none (REP 118).
/// Depths are not among encodings(), as they have neither colors nor a gray. Of all below only matType(), imageSize(),
/// and toEncoding() to the encoding that they have take them.
bool isDepthEncoding(const std::string& encoding);

/// The cv::Mat type that holds an image of this encoding, for instance CV_8UC3 for bgr8.
/// Throws std::invalid_argument naming the encoding if it is unknown.
int matType(const std::string& encoding);

/// Describes a cv::Mat type for users of NumPy and of OpenCV: "3 x 8 bits (CV_8UC3)".
std::string describePixels(int type);

/// Throws std::invalid_argument naming the encoding, the size and what was expected unless `image` can be of this
/// encoding.
void checkPixels(const cv::Mat& image, const std::string& encoding);

/// Throws in the same words unless `image` has pixels of this cv::Mat type; `encoding` may be any name.
void checkPixels(const cv::Mat& image, const std::string& encoding, int type);

/// The size in px that toBgr() would give the image, found without converting it. Throws as checkPixels() does, and if
/// a JPEG is truncated or too large.
cv::Size imageSize(const cv::Mat& image, const std::string& encoding);

/// Converts to gray (CV_8UC1) as cv::cvtColor does. 16 bits are scaled by 255/65535, 10 bits by 255/1023; YUV and JPEG
/// give their luma. `gray` shares the input's pixels if these are gray already (mono8, and the luma of nv12, nv21 and
/// yu12); else it is reused if it fits, and never shares any.
void toGray(const cv::Mat& image, const std::string& encoding, cv::Mat& gray);

/// Whether a converted image lies in the memory of its `source`, so that it must be neither kept nor written to.
bool sharesPixels(const cv::Mat& converted, const cv::Mat& source);

/// Converts to colour (CV_8UC3, BGR order) as cv::cvtColor does. 16 bits are scaled by 255/65535, 10 bits by 255/1023.
/// `bgr` shares the input's pixels if these are bgr8 already; else it is reused if it fits.
void toBgr(const cv::Mat& image, const std::string& encoding, cv::Mat& bgr);

/// Converts in the same way to the encoding `wanted`: the image's own, bgr8, rgb8 or mono8, and also mono16 for mono10
/// (its white, 1023, becomes 65535). `out` shares the input's pixels if nothing has to be changed. Throws
/// std::invalid_argument for any other encoding.
void toEncoding(const cv::Mat& image, const std::string& encoding, const std::string& wanted, cv::Mat& out);

}  // namespace robot_vision
