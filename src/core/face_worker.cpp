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

FaceWorker::~FaceWorker()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

bool FaceWorker::busy() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return job_ || result_;
}

void FaceWorker::wait() const
{
  std::unique_lock<std::mutex> lock(mutex_);
  ended_.wait(lock, [this] { return !job_; });
}

void FaceWorker::start(FaceJob job)
{
  if (!background_)
  {
    result_ = searched(search_, std::move(job), stop_);
    return;
  }
  if (!thread_.joinable()) thread_ = std::thread(&FaceWorker::run, this);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    job_ = std::move(job);
  }
  wake_.notify_one();
}

std::optional<FaceResult> FaceWorker::take()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  return std::exchange(result_, std::nullopt);
}

void FaceWorker::run()
{
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;)
  {
    wake_.wait(lock, [this] { return stop_ || job_; });
    if (stop_) return;
    FaceJob job = *job_;  // job_ stays until its result is there: the worker is busy
    lock.unlock();
    std::optional<FaceResult> result;
    std::exception_ptr error;
    try
    {
      result = searched(search_, std::move(job), stop_);
    }
    catch (...)
    {
      error = std::current_exception();
    }
    lock.lock();
    result_ = std::move(result);
    error_ = error;
    job_.reset();
    ended_.notify_all();
  }
}

}  // namespace robot_vision
