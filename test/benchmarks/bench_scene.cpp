// How long a frame of the synthetic scene takes on one thread: bench_scene [frames]

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "robot_vision/scene/scene.hpp"

namespace
{

void measure(int width, int height, int frames)
{
  robot_vision::SceneParams params;
  params.width = width;
  params.height = height;
  const robot_vision::Scene scene(params);
  cv::Mat picture;
  scene.render(0, picture);  // memory and caches
  std::vector<double> ms;
  for (int frame = 0; frame < frames; ++frame)
  {
    const auto begin = std::chrono::steady_clock::now();
    scene.render(frame, picture);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    ms.push_back(took.count());
  }
  std::sort(ms.begin(), ms.end());
  std::printf("%4dx%-4d  %d frames  min %6.2f ms  median %6.2f ms\n", width, height, frames, ms.front(),
              ms[ms.size() / 2]);
}

}  // namespace

int main(int argc, char** argv)
{
  const int frames = std::max(argc > 1 ? std::atoi(argv[1]) : 300, 1);
  cv::setNumThreads(1);
  measure(640, 480, frames);
  measure(1920, 1080, frames);
  return 0;
}
