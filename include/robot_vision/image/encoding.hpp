#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// Names of the pixel layouts that every function below accepts: those of sensor_msgs/image_encodings.h (bgr8, rgb8,
/// bgra8, rgba8, mono8, mono16, bayer_*8, bayer_*16, yuv422 = UYVY, yuv422_yuy2 = YUYV), and what only cameras give:
/// mono10 (10 bits in the low end of 16), nv12, nv21 and yu12 (the luma, below it the chroma, in one picture of 3/2 of
/// the height) and jpeg.
std::vector<std::string> encodings();

/// Whether it is one of encodings().
bool isEncoding(const std::string& encoding);

/// Whether it is one of encodings() that a sensor_msgs/Image can have.
bool isMessageEncoding(const std::string& encoding);

/// The cv::Mat type that holds a picture of this encoding, for instance CV_8UC3 for bgr8.
/// Throws std::invalid_argument naming the encoding if it is unknown.
int matType(const std::string& encoding);

/// "3 x 8 bits (CV_8UC3)", a cv::Mat type for users of NumPy and of OpenCV.
std::string describePixels(int type);

/// Throws std::invalid_argument naming encoding, size and what was expected if `image` cannot be a picture of it.
void checkPixels(const cv::Mat& image, const std::string& encoding);

/// The size in px of the picture that toBgr() would make, without making it. Throws as checkPixels does, and if a JPEG
/// is truncated or too large.
cv::Size pictureSize(const cv::Mat& image, const std::string& encoding);

/// Gray picture (CV_8UC1) as cv::cvtColor makes it; 16 bits are scaled by 255/65535, 10 by 255/1023; of YUV and JPEG
/// the luma itself.
/// `gray` shares the input's pixels where they are gray already, is reused if it fits, and never aliases other input.
void toGray(const cv::Mat& image, const std::string& encoding, cv::Mat& gray);

/// Whether a converted picture lies in the memory of its `source`, and so must not be kept or written.
bool sharesPixels(const cv::Mat& picture, const cv::Mat& source);

/// Colour picture (CV_8UC3, BGR order) as cv::cvtColor makes it; 16 bits are scaled by 255/65535, 10 by 255/1023.
/// `bgr` shares the input's pixels where they are bgr8 already, and is reused if it fits.
void toBgr(const cv::Mat& image, const std::string& encoding, cv::Mat& bgr);

/// The same in RGB order.
void toRgb(const cv::Mat& image, const std::string& encoding, cv::Mat& rgb);

/// The picture as `wanted`: what it is already, bgr8, rgb8, mono8, or of mono10 mono16 (white 1023 becomes 65535).
/// `out` shares the input's pixels where nothing has to be changed. Throws std::invalid_argument for anything else.
void toEncoding(const cv::Mat& image, const std::string& encoding, const std::string& wanted, cv::Mat& out);

}  // namespace robot_vision
