#include "robot_vision/scene/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "depth_sensor.hpp"
#include "depth_surfaces.hpp"
#include "noise_rows.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "scene_random.hpp"

namespace robot_vision
{

namespace
{

const float kNan = std::numeric_limits<float>::quiet_NaN();
const double kInfinity = std::numeric_limits<double>::infinity();
const double kSteepest = 8.0;  // tangent of 83 degrees; what seems to be steeper is an edge

/// Copies depth, and makes NaN of what is none.
void withoutWrong(const cv::Mat& depth, cv::Mat& out)
{
  depth.copyTo(out);
  for (int row = 0; row < out.rows; ++row)
    for (int column = 0; column < out.cols; ++column)
      if (float& z = out.at<float>(row, column); !scene::isDepth(z)) z = kNan;
}

/// Throws std::invalid_argument naming the image unless it has this type and size.
void checkImage(const cv::Mat& image, const std::string& name, int type, const cv::Size& size)
{
  checkPixels(image, name, type);
  require(image.size() == size, "the size of the " + name + " image", toText(image.size()),
          "that of the camera, " + toText(size));
}

}  // namespace

struct DepthNoise::Impl
{
  Impl(DepthSensor sensor, const CameraModel& camera, std::uint64_t any_seed);

  void measureRow(const cv::Mat& inverse, const cv::Mat& brightness, int row, std::uint64_t key, const float* normal,
                  float* noisy) const;
  double shareLost(const cv::Mat& inverse, cv::Point at, double light) const;
  double measured(double inverse, double light, double normal) const;

  DepthSensor kind;
  const scene::DepthSensorModel& model;
  cv::Size size;
  cv::Point2d focal;  // px
  double disparity;   // px m, of 1/z
  std::uint64_t seed;
  RayTable rays;
  std::vector<float> normals;
};

DepthNoise::Impl::Impl(DepthSensor sensor, const CameraModel& camera, std::uint64_t any_seed)
  : kind(sensor),
    model(scene::sensorModel(sensor)),
    size((validate(camera), camera.width), camera.height),
    focal(camera.K(0, 0), camera.K(1, 1)),
    disparity(model.baseline * focal.x),
    seed(scene::mix(any_seed))
{
  if (kind == DepthSensor::kExact) return;
  rays = rayTable(camera);
  normals = scene::NoiseRows::independentNumbers(seed, camera.width, model.block);
}

/// The share of pixels that are lost on the surface at a pixel.
double DepthNoise::Impl::shareLost(const cv::Mat& inverse, cv::Point at, double light) const
{
  const double square = scene::squaredCosine(inverse, at, {rays.x.at<float>(at), rays.y.at<float>(at)}, focal);
  if (square >= scene::kSteepCosine * scene::kSteepCosine) return scene::lostAtBrightness(light);
  return 1.0 - (1.0 - scene::lostAtAngle(std::sqrt(square))) * (1.0 - scene::lostAtBrightness(light));
}

/// The z that is measured at an exact 1/z. `normal` is a normally distributed number.
double DepthNoise::Impl::measured(double inverse, double light, double normal) const
{
  const double z = 1.0 / inverse;
  const double sigma = model.sigma(z, disparity, light);
  if (model.step <= 0.0) return z + sigma * normal;
  const double in_pixels = sigma * disparity * inverse * inverse;
  const double random = std::sqrt(std::max(in_pixels * in_pixels - model.step * model.step / 12.0, 0.0));
  const int steps = cvRound((disparity * inverse + random * normal) / model.step);
  return disparity / (steps * model.step);
}

/// `normal` are the random numbers of the row's errors; what else is random depends on its key.
void DepthNoise::Impl::measureRow(const cv::Mat& inverse, const cv::Mat& brightness, int row, std::uint64_t key,
                                  const float* normal, float* noisy) const
{
  double leftmost = kInfinity;  // ray of the other device to what it sees of the pixels at the right
  for (int column = inverse.cols - 1; column >= 0; --column)
  {
    noisy[column] = kNan;
    const cv::Point at(column, row);
    const double here = inverse.at<float>(at);
    if (here <= 0.0) continue;
    // What is farther to the right for the other device than something farther to the left for this one is behind it.
    const double place = rays.x.at<float>(at) - model.baseline * here;
    const bool hidden = place > leftmost;
    leftmost = std::min(leftmost, place);
    if (hidden) continue;
    std::uint64_t state = key + static_cast<std::uint64_t>(column);
    const auto chance = [&state] { return scene::unitInterval(state = scene::mix(state)); };
    const double light = brightness.empty() ? 128.0 : brightness.at<std::uint8_t>(at);
    const double share = shareLost(inverse, at, light);
    if (share > 0.0 && chance() < share) continue;
    double mixed = here;
    const double other = model.flying > 0.0 ? scene::beyondEdge(inverse, at, kSteepest / focal.x) : 0.0;
    if (other > 0.0 && chance() < model.flying)
    {
      const double part = chance();
      mixed = model.step > 0.0 ? here + part * (other - here) : 1.0 / ((1.0 - part) / here + part / other);
    }
    const double z = measured(mixed, light, normal[column]);
    if (z >= model.min_range && z <= model.max_range) noisy[column] = static_cast<float>(z);
  }
}

DepthNoise::DepthNoise(DepthSensor sensor, const CameraModel& depth_camera, std::uint64_t seed)
  : impl_(std::make_unique<const Impl>(sensor, depth_camera, seed))
{
}

DepthNoise::~DepthNoise() = default;

void DepthNoise::apply(std::int64_t frame, const cv::Mat& exact, const cv::Mat& brightness, cv::Mat& noisy) const
{
  checkImage(exact, "depth", CV_32FC1, impl_->size);
  if (!brightness.empty()) checkImage(brightness, "brightness", CV_8UC1, impl_->size);
  if (impl_->kind == DepthSensor::kExact)
  {
    withoutWrong(exact, noisy);
    return;
  }
  const cv::Mat inverse = scene::inverseDepths(exact);
  noisy.create(impl_->size, CV_32FC1);
  const std::uint64_t frame_key = scene::mix(impl_->seed ^ static_cast<std::uint64_t>(frame));
  scene::NoiseRows normals(impl_->normals, inverse.cols, impl_->model.block, frame_key);
  for (int row = 0; row < inverse.rows; ++row)
    impl_->measureRow(inverse, brightness, row, scene::rowKey(frame_key, row), normals.next(), noisy.ptr<float>(row));
}

}  // namespace robot_vision
