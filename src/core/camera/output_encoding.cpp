#include "robot_vision/camera/output_encoding.hpp"

#include "robot_vision/common/fields.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

void validateOutputEncoding(const std::string& wanted)
{
  checkField("output_encoding", wanted, OneOf{"auto, bgr8, rgb8, mono8 or native", "'"});
}

std::string outputEncoding(const std::string& wanted, const std::string& given)
{
  if (isDepthEncoding(given)) return given;
  if (wanted == "auto") return given == "mono8" || given == "mono10" || given == "mono16" ? "mono8" : "bgr8";
  if (wanted != "native") return wanted;
  if (given == "mono10") return "mono16";
  return isMessageEncoding(given) ? given : "bgr8";
}

}  // namespace robot_vision
