#include "opencv_codecs.hpp"

#include "robot_vision/common/on_demand.hpp"

namespace robot_vision
{

cv::Mat decodeByOpenCv(const cv::Mat& bytes, int flags)
{
  static auto* const decode = onDemand<decltype(robot_vision_imdecode)>("codecs", "robot_vision_imdecode");
  cv::Mat image;
  decode(bytes, flags, image);
  return image;
}

void encodeByOpenCv(const std::string& extension, const cv::Mat& image, const std::vector<int>& params,
                    std::vector<std::uint8_t>& out)
{
  static auto* const encode = onDemand<decltype(robot_vision_imencode)>("codecs", "robot_vision_imencode");
  encode(extension, image, params, out);
}

bool isReadByOpenCv(const std::string& path)
{
  static auto* const has_reader =
      onDemand<decltype(robot_vision_have_image_reader)>("codecs", "robot_vision_have_image_reader");
  return has_reader(path);
}

}  // namespace robot_vision
