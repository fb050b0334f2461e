#include "face_worker.hpp"

#include <utility>

namespace robot_vision
{
namespace
{

FaceResult searched(FaceSearch& search, FaceJob job, const std::atomic<bool>& stop)
{
  FaceResult result;
  for (const cv::Rect& part : job.parts)
  {
    const std::vector<FoundFace> found = search.find(job.gray, part, job.windows, &stop);
    result.found.insert(result.found.end(), found.begin(), found.end());
  }
  result.job = std::move(job);
  return result;
}

}  // namespace

FaceWorker::FaceWorker(const FaceParams& params, bool background) : search_(params), background_(background)
{
}

void FaceWorker::start(FaceJob job)
{
  if (background_ && task_.start([this, job] { return searched(search_, job, stop_); })) return;
  result_ = searched(search_, std::move(job), stop_);
}

std::optional<FaceResult> FaceWorker::take()
{
  return result_ ? std::exchange(result_, std::nullopt) : task_.take();
}

}  // namespace robot_vision
