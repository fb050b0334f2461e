#include "scene_second_view.hpp"

#include <opencv2/imgproc.hpp>

#include "robot_vision/depth/depth_image.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint8_t kUnseenBrightness = 128;  // what DepthNoise takes where nothing is known

}  // namespace

DepthBrightness::DepthBrightness(const CameraModel& depth_camera, const CameraModel& color_camera,
                                 const cv::Affine3d& pose)
  : far_x_(depth_camera.height, depth_camera.width, CV_32FC1),
    far_y_(depth_camera.height, depth_camera.width, CV_32FC1),
    shift_(color_camera.K(0, 0) * pose.translation()[0])
{
  const RayTable rays = rayTable(depth_camera);
  for (int y = 0; y < far_x_.rows; ++y)
    for (int x = 0; x < far_x_.cols; ++x)
    {
      const cv::Point2d pixel = color_camera.project({rays.x.at<float>(y, x), rays.y.at<float>(y, x), 1.0});
      far_x_.at<float>(y, x) = static_cast<float>(pixel.x);
      far_y_.at<float>(y, x) = static_cast<float>(pixel.y);
    }
}

/// Near things are seen beside far ones on a line that the lens bends, by less than a pixel.
const cv::Mat& DepthBrightness::measure(const cv::Mat& bgr, const cv::Mat& metres)
{
  toGray(bgr, "bgr8", gray_);
  cv::divide(shift_, metres, x_);
  x_ += far_x_;
  cv::patchNaNs(x_, -2.0);  // outside of the image
  cv::remap(gray_, brightness_, x_, far_y_, cv::INTER_NEAREST, cv::BORDER_CONSTANT, kUnseenBrightness);
  return brightness_;
}

SceneSecondView::SceneSecondView(const Scene& scene, const CaptureParams& params)
  : scene_(scene), is_right_(params.views == "stereo"), encoding_(is_right_ ? "bgr8" : params.depth_encoding)
{
  const SceneView view = is_right_ ? SceneView::kRight : SceneView::kDepth;
  camera_ = {scene.camera(view), scene.viewPose(view)};
  if (is_right_ || params.depth_noise == "none") return;
  noise_ = std::make_unique<const DepthNoise>(depthSensor(params.depth_noise), camera_.model, SceneParams().seed);
  brightness_ = std::make_unique<DepthBrightness>(camera_.model, scene.camera(), camera_.pose);
}

void SceneSecondView::render(std::int64_t frame, const cv::Mat& bgr, EncodedImage& image)
{
  image.encoding = encoding_;
  if (is_right_)
    scene_.render(frame, image.pixels, SceneView::kRight);
  else
    renderDepth(frame, bgr, image.pixels);
}

void SceneSecondView::renderDepth(std::int64_t frame, const cv::Mat& bgr, cv::Mat& depth)
{
  cv::Mat& metres = encoding_ == "32FC1" ? depth : metres_;
  scene_.renderDepth(frame, metres);
  if (noise_)
  {
    if (bgr.empty()) scene_.render(frame, bgr_);
    noise_->apply(frame, metres, brightness_->measure(bgr.empty() ? bgr_ : bgr, metres), metres);
  }
  if (encoding_ != "32FC1") toMillimetres(metres, "32FC1", depth);
}

}  // namespace robot_vision
