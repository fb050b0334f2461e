#include "core/codecs/opencv_codecs.hpp"

#include <opencv2/imgcodecs.hpp>

void robot_vision_imdecode(const cv::Mat& bytes, int flags, cv::Mat& image)
{
  image = cv::imdecode(bytes, flags);
}

void robot_vision_imencode(const std::string& extension, const cv::Mat& image, const std::vector<int>& params,
                           std::vector<std::uint8_t>& out)
{
  cv::imencode(extension, image, out, params);
}

bool robot_vision_have_image_reader(const std::string& path)
{
  return cv::haveImageReader(path);
}
