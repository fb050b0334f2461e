// The bare OpenCV chain at a camera's pace, without ROS: bench_chain IMAGE WIDTH HEIGHT SECONDS RATE THREADS
// THREADS is OpenCV's, 0: as many as it likes. Prints JSON; the latency is the time that a frame takes.

#include <chrono>
#include <cstdlib>
#include <exception>
#include <thread>

#include "measure.hpp"

namespace
{

bench::Result run(const std::vector<cv::Mat>& images, int frames, double rate)
{
  constexpr int kWarmUp = 15;
  using Clock = std::chrono::steady_clock;
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate));
  bench::Result result;
  bench::EdgeChain chain;
  cv::Mat edges;
  double wall_begin = 0.0;
  double cpu_begin = 0.0;
  auto next = Clock::now();
  for (int i = -kWarmUp; i < frames; ++i)
  {
    std::this_thread::sleep_until(next);
    next += period;
    const double begin = bench::seconds(CLOCK_MONOTONIC);
    if (i == 0)
    {
      wall_begin = begin;
      cpu_begin = bench::seconds(CLOCK_PROCESS_CPUTIME_ID);
    }
    chain.apply(images[static_cast<std::size_t>(i + kWarmUp) % images.size()], edges);
    if (i >= 0) result.latencies_ms.push_back((bench::seconds(CLOCK_MONOTONIC) - begin) * 1e3);
  }
  std::this_thread::sleep_until(next);
  result.sent = frames;
  result.seconds = bench::seconds(CLOCK_MONOTONIC) - wall_begin;
  result.cpu_seconds = bench::seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_begin;
  return result;
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc != 7) throw std::invalid_argument("bench_chain IMAGE WIDTH HEIGHT SECONDS RATE THREADS");
  const double rate = std::atof(argv[5]);
  const int threads = std::atoi(argv[6]);
  if (threads > 0) cv::setNumThreads(threads);
  const auto images = bench::movingImage(argv[1], {std::atoi(argv[2]), std::atoi(argv[3])});
  bench::print(run(images, static_cast<int>(std::atof(argv[4]) * rate), rate));
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_chain: %s\n", e.what());
  return 1;
}
