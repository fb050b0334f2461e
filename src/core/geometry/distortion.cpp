#include "distortion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robot_vision/geometry/distortion_models.hpp"

namespace robot_vision
{

namespace
{

using Coefficients = std::array<double, 8>;

const int kMaxSteps = 20;              // of Newton's method, which needs about five
const double kConvergedError = 1e-14;  // error below which one more step is the last
const double kMaxError = 1e-9;         // error after the last step above which there is no solution
const double kUnlimited = std::numeric_limits<double>::infinity();
const cv::Point2d kNoPoint(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN());

// Farther out than its image a distortion model may turn back towards the centre, and outward again after that: the
// second branch shows pixels that the first one has shown already. The functions below give the square of a distance
// from the axis at which the model turns back, so that no ray of the first branch is beyond it and none of the second
// within it. They leave out the tangential distortion, which moves the ends of the branches a little only.

// Of a polynomial without a divisor: where its slope 1 + 3 k1 r^2 + 5 k2 r^4 + 7 k3 r^6 has its minimum.
double turnOfPolynomial(const Coefficients& D)
{
  const double k1 = D[0], k2 = D[1], k3 = D[4];
  const double a = 21.0 * k3, b = 10.0 * k2, c = 3.0 * k1;  // of a r^4 + b r^2 + c, the derivative of the slope by r^2
  const double root = std::sqrt(b * b - 4.0 * a * c);
  const double r2 = b > 0.0 ? -2.0 * c / (b + root) : (root - b) / (2.0 * a);
  const double slope = 1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3));
  return r2 > 0.0 && slope < 0.0 ? r2 : kUnlimited;
}

// Of any other model, which shows a distance from the axis at shown(distance), or has a pole where that is NaN.
template <typename Shown>
double turnOf(const Shown& shown, double end)
{
  const double start = 0.05, ratio = 1.1;
  double last_shown = 0.0, last = 0.0, turn = 0.0;
  for (double distance = start; distance < end; last = distance, distance *= ratio)
  {
    const double now = shown(distance);
    const bool outward = now >= last_shown;
    if (outward && turn > 0.0) return turn * last;
    if (!outward && turn == 0.0) turn = distance;
    last_shown = now;
  }
  return turn > 0.0 ? turn * end : kUnlimited;
}

double turnOfRational(const Coefficients& D)
{
  const double end = 10.0;  // 84 degrees from the axis
  const auto shown = [&D](double r)
  {
    const double r2 = r * r, divisor = 1.0 + r2 * (D[5] + r2 * (D[6] + r2 * D[7]));
    return divisor > 0.0 ? r * (1.0 + r2 * (D[0] + r2 * (D[1] + r2 * D[4]))) / divisor : kNoPoint.x;
  };
  return turnOf(shown, end);
}

// The model of cv::projectPoints (OpenCV, calib3d).
Distorted byPolynomial(const Coefficients& D, const cv::Point2d& p)
{
  const double x = p.x, y = p.y, r2 = x * x + y * y;
  const double k1 = D[0], k2 = D[1], p1 = D[2], p2 = D[3], k3 = D[4], k4 = D[5], k5 = D[6], k6 = D[7];
  const double divisor = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / divisor;
  const double growth = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3) - radial * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6));
  const double slope = 2.0 * growth / divisor;  // d radial / d x = slope * x
  const double mixed = x * y * slope + 2.0 * (p1 * x + p2 * y);
  Distorted result;
  result.point = {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
                  y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
  result.jacobian = {radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed, mixed,
                     radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x};
  return result;
}

// The distance from the image centre at which a lens shows an angle (rad) from its axis, and its derivative: Kannala
// and Brandt, A Generic Camera Model and Calibration Method for Conventional, Wide-Angle, and Fish-Eye Lenses, PAMI
// 2006, with the four terms of cv::fisheye.
struct Radius
{
  double value, slope;
};

Radius radiusOf(const Coefficients& D, double angle)
{
  const double a2 = angle * angle;
  return {angle * (1.0 + a2 * (D[0] + a2 * (D[1] + a2 * (D[2] + a2 * D[3])))),
          1.0 + a2 * (3.0 * D[0] + a2 * (5.0 * D[1] + a2 * (7.0 * D[2] + a2 * 9.0 * D[3])))};
}

double turnOfAngle(const Coefficients& D)
{
  return turnOf([&D](double angle) { return radiusOf(D, angle).value; }, CV_PI / 2.0);
}

Distorted byAngle(const Coefficients& D, const cv::Point2d& p)
{
  const double r2 = p.dot(p), r = std::sqrt(r2), tiny = 1e-8;
  if (r < tiny) return {p, cv::Matx22d::eye()};
  const Radius radius = radiusOf(D, std::atan(r));
  const double scale = radius.value / r;
  const double bend = (radius.slope / (1.0 + r2) - scale) / r2;
  return {scale * p, {scale + bend * p.x * p.x, bend * p.x * p.y, bend * p.x * p.y, scale + bend * p.y * p.y}};
}

// Whether what is farther from the axis than a point is seen farther out in the image, too, and on the same side.
bool isOutward(const Distorted& seen, const cv::Point2d& point)
{
  return cv::determinant(seen.jacobian) > 0.0 && seen.point.dot(point) >= 0.0;
}

cv::Point2d undistortPolynomial(const Coefficients& D, double turn, const cv::Point2d& target, cv::Point2d guess)
{
  const auto checked = [turn](const Distorted& seen, const cv::Point2d& point)
  { return point.dot(point) < turn && isOutward(seen, point) ? point : kNoPoint; };
  for (int step = 0; step < kMaxSteps; ++step)
  {
    const Distorted now = byPolynomial(D, guess);
    const cv::Point2d error = target - now.point;
    const cv::Matx22d& J = now.jacobian;
    const double det = J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
    guess.x += (J(1, 1) * error.x - J(0, 1) * error.y) / det;
    guess.y += (J(0, 0) * error.y - J(1, 0) * error.x) / det;
    if (error.dot(error) < kConvergedError * kConvergedError) return checked(now, guess);
  }
  const Distorted reached = byPolynomial(D, guess);
  const cv::Point2d error = target - reached.point;
  return error.dot(error) < kMaxError * kMaxError ? checked(reached, guess) : kNoPoint;
}

cv::Point2d undistortAngle(const Coefficients& D, double turn, const cv::Point2d& target)
{
  const double wanted = std::hypot(target.x, target.y), tiny = 1e-8;
  if (wanted < tiny) return target;
  double angle = std::min(wanted, CV_PI / 2.0);
  for (int step = 0; step < kMaxSteps; ++step)
  {
    const Radius now = radiusOf(D, angle);
    angle += (wanted - now.value) / now.slope;
    if (std::abs(wanted - now.value) < kConvergedError) break;
  }
  const Radius reached = radiusOf(D, angle);
  const bool found = std::abs(wanted - reached.value) < kMaxError && reached.slope > 0.0 && angle * angle < turn;
  return found && angle > 0.0 && angle < CV_PI / 2.0 ? std::tan(angle) / wanted * target : kNoPoint;
}

}  // namespace

Distortion::Distortion(const CameraModel& camera) : equidistant_(isEquidistant(camera.distortion_model))
{
  std::copy_n(camera.D.begin(), std::min(camera.D.size(), D_.size()), D_.begin());
}

Distorted Distortion::distort(const cv::Point2d& point) const
{
  return equidistant_ ? byAngle(D_, point) : byPolynomial(D_, point);
}

Undistortion::Undistortion(const CameraModel& camera) : lens_(camera)
{
  const Coefficients& D = lens_.D_;
  const bool rational = D[5] != 0.0 || D[6] != 0.0 || D[7] != 0.0;
  turn_ = lens_.equidistant_ ? turnOfAngle(D) : rational ? turnOfRational(D) : turnOfPolynomial(D);
}

bool Undistortion::holds(const cv::Point2d& point) const
{
  double place = point.dot(point);
  if (lens_.equidistant_)
  {
    const double angle = std::atan(std::sqrt(place));
    place = angle * angle;
  }
  return place < turn_ && isOutward(lens_.distort(point), point);
}

cv::Point2d Undistortion::undistort(const cv::Point2d& target, const cv::Point2d& guess) const
{
  return lens_.equidistant_ ? undistortAngle(lens_.D_, turn_, target)
                            : undistortPolynomial(lens_.D_, turn_, target, guess);
}

}  // namespace robot_vision
