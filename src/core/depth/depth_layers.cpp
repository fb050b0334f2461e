#include "depth_layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace robot_vision
{
namespace
{

// Of the logarithm of the depth: what is far away may be as much deeper as it is larger, and is measured less well.
constexpr double kBin = 0.04;
constexpr double kNearest = 0.01;    // m, where the first bin begins; what is nearer is in it
constexpr std::size_t kBins = 290;   // up to 1.09 km
constexpr double kValley = 0.5;      // between two layers, at most this share of the lower peak
constexpr double kEdge = 0.1;        // a layer ends where there is less than this share of its peak
constexpr double kDeviations = 2.0;  // by which a peak is higher than the valley before it, in those of its count

using Histogram = std::array<double, kBins>;

std::size_t binOf(double depth)
{
  const double bin = std::log(depth / kNearest) / kBin;
  return static_cast<std::size_t>(std::clamp(bin, 0.0, kBins - 1.0));
}

/// Where a bin begins, m; the first one has all that is nearer.
double beginOf(std::size_t bin)
{
  return bin == 0 ? 0.0 : kNearest * std::exp(kBin * static_cast<double>(bin));
}

Histogram histogramOf(const std::vector<RegionSample>& samples)
{
  Histogram counts = {};
  for (const RegionSample& sample : samples)
    counts[binOf(sample.depth)] += sample.weight;
  return counts;
}

Histogram smoothed(const Histogram& counts)
{
  Histogram smooth;
  for (std::size_t i = 0; i < kBins; ++i)
    smooth[i] = 0.25 * (counts[i == 0 ? 0 : i - 1] + 2.0 * counts[i] + counts[std::min(i + 1, kBins - 1)]);
  return smooth;
}

/// The bins from `begin` to before `end`.
struct Bins
{
  std::size_t begin;
  std::size_t end;
};

/// Divides the histogram at the lowest bins of its valleys. `weight` is that of one sample: it decides which rise is
/// one, and which is chance.
std::vector<Bins> dividedAtValleys(const Histogram& smooth, double weight)
{
  std::vector<Bins> parts;
  std::size_t begin = 0, lowest = 0;  // bins: of the part, and of the valley after its peak
  double peak = smooth[0];
  for (std::size_t i = 1; i < kBins; ++i)
  {
    const double height = smooth[i], low = smooth[lowest];
    const bool rises = height - low > kDeviations * std::sqrt(height * weight);
    if (rises && low < kValley * std::min(peak, height))
    {
      parts.push_back({begin, lowest + 1});
      begin = lowest + 1;
      peak = 0.0;
    }
    if (height > peak)
    {
      peak = height;
      lowest = i;
    }
    else if (height <= smooth[lowest])
      lowest = i;
  }
  parts.push_back({begin, kBins});
  return parts;
}

/// What hangs together with the peak of a part of the histogram.
DepthLayer layerAt(const Bins& part, const Histogram& counts, const Histogram& smooth, double total)
{
  std::size_t peak = part.begin;
  for (std::size_t i = part.begin; i < part.end; ++i)
    if (smooth[i] > smooth[peak]) peak = i;
  const double edge = kEdge * smooth[peak];
  std::size_t begin = peak, end = peak + 1;
  while (begin > part.begin && smooth[begin - 1] >= edge)
    --begin;
  while (end < part.end && smooth[end] >= edge)
    ++end;
  DepthLayer layer = {beginOf(begin), beginOf(end), 0.0};
  for (std::size_t i = begin; i < end; ++i)
    layer.share += counts[i] / total;
  return layer;
}

}  // namespace

DepthLayer nearestLayer(const std::vector<RegionSample>& samples, double min_share)
{
  const Histogram counts = histogramOf(samples), smooth = smoothed(counts);
  double total = 0.0;
  for (const double count : counts)
    total += count;
  DepthLayer largest;
  for (const Bins& part : dividedAtValleys(smooth, total / static_cast<double>(samples.size())))
  {
    const DepthLayer layer = layerAt(part, counts, smooth, total);
    if (layer.share >= min_share && layer.share > 0.0) return layer;
    if (layer.share > largest.share) largest = layer;
  }
  return largest;
}

}  // namespace robot_vision
