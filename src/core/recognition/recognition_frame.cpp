#include "robot_vision/recognition/recognition_frame.hpp"

#include "color_gradients.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/geometry/distortion_models.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

RecognitionFrame::RecognitionFrame(const CameraModel& camera) : camera_((validate(camera), camera))
{
  require(!isDistorted(camera), "the distortion of the camera", "that of a lens", "none: its images must be rectified");
}

void RecognitionFrame::set(const cv::Mat& bgr, const cv::Mat& depth, const std::string& encoding)
{
  require(!bgr.empty() || !depth.empty(), "the frame", "empty", "an image of colors, of depths, or both");
  if (!bgr.empty())
  {
    checkPixels(bgr, "bgr8");
    require(bgr.size() == size(), "the size of the color image", toText(bgr.size()),
            toText(size()) + " as of its camera");
  }
  if (!depth.empty()) checkDepth(depth, encoding, size());
  bgr_ = bgr;
  gradients_.release();
  if (!bgr.empty()) colorGradients(bgr, gradients_);
  depth_.release();
  if (depth.empty()) return;
  toMetres(depth, encoding, metres_);
  depth_ = metres_;
}

}  // namespace robot_vision
