#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// cv::imdecode, cv::imencode and cv::haveImageReader, whose library is loaded by the first call, see on_demand.hpp.
cv::Mat decodeByOpenCv(const cv::Mat& bytes, int flags);
void encodeByOpenCv(const std::string& extension, const cv::Mat& image, const std::vector<int>& params,
                    std::vector<std::uint8_t>& out);
bool isReadByOpenCv(const std::string& path);

}  // namespace robot_vision

extern "C"
{
  // Those of the library "codecs".
  void robot_vision_imdecode(const cv::Mat& bytes, int flags, cv::Mat& image);
  void robot_vision_imencode(const std::string& extension, const cv::Mat& image, const std::vector<int>& params,
                             std::vector<std::uint8_t>& out);
  bool robot_vision_have_image_reader(const std::string& path);
}
