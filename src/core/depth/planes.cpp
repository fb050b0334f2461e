#include "robot_vision/depth/planes.hpp"

#include "plane_search.hpp"

namespace robot_vision
{

struct PlaneFinder::Impl : PlaneSearch
{
  using PlaneSearch::PlaneSearch;
};

PlaneFinder::PlaneFinder(const CameraModel& camera, const PlaneParams& params)
  : impl_(std::make_unique<Impl>(camera, params))
{
}

PlaneFinder::~PlaneFinder() = default;

const PlaneSegmentation& PlaneFinder::find(const cv::Mat& depth, const std::string& encoding)
{
  return impl_->find(depth, encoding);
}

}  // namespace robot_vision
