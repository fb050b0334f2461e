// Our work on pixels beside the calls of OpenCV that it replaces, with Google Benchmark:
// bench_kernels IMAGE [--sizes=WIDTHxHEIGHT,...] [--threads=N] [--all-sets] [--growth] [--benchmark_...]
//
// Both see the same frames in turns, and keep their memory; each measures the median over them, of the CPU's time or,
// with several threads, of a clock. Counters: ms per frame of both, how many times as fast ours is and is to be; an
// error instead, if a result differs. --all-sets: with the loops of every instruction set that the machine has, instead
// of the best; --growth: only what is to grow with the size of the image.

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <iostream>
#include <sstream>

#include "core/simd/instruction_sets.hpp"
#include "kernels/contests.hpp"
#include "measure.hpp"
#include "robot_vision/common/range.hpp"

namespace
{

using bench::Contest;
using bench::Work;
using robot_vision::InstructionSet;

struct Options
{
  std::string image;
  std::vector<cv::Size> sizes = {{640, 480}, {1920, 1080}, {3840, 2160}};
  int threads = 1;
  bool all_sets = false;
  bool growth = false;
};

std::vector<cv::Size> parseSizes(std::istringstream text)
{
  std::vector<cv::Size> sizes;
  cv::Size size;
  for (char x, comma = ','; comma == ',' && text >> size.width >> x >> size.height && x == 'x'; text >> comma)
  {
    sizes.push_back(size);
    comma = ' ';
  }
  if (!text.eof() || sizes.empty()) throw std::invalid_argument("--sizes: expected WIDTHxHEIGHT,WIDTHxHEIGHT,...");
  return sizes;
}

Options parse(int argc, char** argv)
{
  Options options;
  for (int i = 1; i < argc; ++i)
  {
    const std::string argument = argv[i];
    const auto value = [&argument] { return argument.substr(argument.find('=') + 1); };
    if (argument.rfind("--sizes=", 0) == 0)
      options.sizes = parseSizes(std::istringstream(value()));
    else if (argument.rfind("--threads=", 0) == 0)
      options.threads = std::atoi(value().c_str());
    else if (argument == "--all-sets")
      options.all_sets = true;
    else if (argument == "--growth")
      options.growth = true;
    else if (argument.rfind("--", 0) == 0 || !options.image.empty())
      throw std::invalid_argument("no such option: " + argument);
    else
      options.image = argument;
  }
  if (options.image.empty() || options.threads < 1)
    throw std::invalid_argument("expected IMAGE, and at least 1 thread");
  return options;
}

/// The last one that was asked for: Google Benchmark runs each several times, and all of them would fill the memory.
class Prepared
{
public:
  const Contest& get(const Options& options, const Work& work, const cv::Size& size, InstructionSet set)
  {
    robot_vision::chooseSet(set);
    if (size != size_) frames_ = bench::movingImage(options.image, size);
    if (size != size_ || &work != work_ || set != set_) contest_ = work.prepare({frames_, options.threads});
    size_ = size;
    work_ = &work;
    set_ = set;
    return contest_;
  }

  std::size_t frames() const { return frames_.size(); }

private:
  cv::Size size_;
  const Work* work_ = nullptr;
  std::optional<InstructionSet> set_;
  std::vector<cv::Mat> frames_;
  Contest contest_;
};

Prepared prepared;

void measure(benchmark::State& state, const Options& options, const Work& work, const cv::Size& size,
             InstructionSet set)
{
  cv::setNumThreads(options.threads);
  const Contest& contest = prepared.get(options, work, size, set);
  const clockid_t clock = options.threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
  std::vector<double> theirs, ours;  // ms
  const auto time = [&](const auto& side, std::size_t i, std::vector<double>& times)
  {
    const double begin = bench::seconds(clock);
    side(i);
    times.push_back((bench::seconds(clock) - begin) * 1e3);
  };
  contest.theirs(0);  // memory and caches
  contest.ours(0);
  for (auto unused : state)
  {
    static_cast<void>(unused);
    const std::size_t i = ours.size() % prepared.frames();
    const bool ours_first = ours.size() % 2 == 1;  // the second finds the image in the cache
    if (ours_first) time(contest.ours, i, ours);
    time(contest.theirs, i, theirs);
    if (!ours_first) time(contest.ours, i, ours);
    state.SetIterationTime((theirs.back() + ours.back()) * 1e-3);
    if (!contest.same())
    {
      state.SkipWithError("the results differ");
      return;
    }
  }
  state.SetLabel(work.against);
  state.counters["theirs_ms"] = bench::median(theirs);
  state.counters["ours_ms"] = bench::median(ours);
  state.counters["times"] = bench::median(theirs) / bench::median(ours);
  state.counters["goal"] = work.goal;
  state.counters["pixels"] = size.area();
}

void registerAll(const Options& options, const std::vector<Work>& works)
{
  std::vector<InstructionSet> sets = robot_vision::availableSets();
  if (!options.all_sets) sets.resize(1);
  for (const cv::Size& size : options.sizes)
    for (const Work& work : works)
      for (InstructionSet set : sets)
      {
        if (options.growth && !work.scales) continue;
        const std::string name = work.name + "/" + robot_vision::toText(size) + "/" + robot_vision::name(set) + "/" +
                                 std::to_string(options.threads);
        const auto run = [&options, &work, size, set](benchmark::State& state)
        { measure(state, options, work, size, set); };
        benchmark::RegisterBenchmark(name.c_str(), run)->UseManualTime()->Unit(benchmark::kMillisecond);
      }
}

std::vector<Work> allWorks()
{
  std::vector<Work> all;
  for (const auto& part :
       {bench::edgeWorks(), bench::hsvWorks(), bench::motionWorks(), bench::brightnessWorks(), bench::filterWorks(),
        bench::conversionWorks(), bench::jpegWorks(), bench::depthWorks(), bench::normalWorks(), bench::tabletopWorks(),
        bench::meshWorks(), bench::sceneWorks(), bench::faceWorks()})
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace

int main(int argc, char** argv)
try
{
  benchmark::Initialize(&argc, argv);
  const Options options = parse(argc, argv);
  const std::vector<Work> works = allWorks();
  registerAll(options, works);
  return benchmark::RunSpecifiedBenchmarks() > 0 ? 0 : 1;
}
catch (const std::exception& e)
{
  std::cerr << "bench_kernels: " << e.what() << "\n";
  return 1;
}
