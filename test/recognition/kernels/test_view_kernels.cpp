// The loops that compare views with frames: against plain code, and against those of the baseline to the bit. What they
// read and write is as long as it must be, so that the sanitizers see accesses beyond it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <vector>

#include "core/recognition/fit_kernels.hpp"
#include "core/recognition/frame_kernels.hpp"
#include "core/recognition/look_kernels.hpp"
#include "core/recognition/padded_image.hpp"
#include "core/recognition/search_kernels.hpp"

using namespace robot_vision;

namespace
{

constexpr int kCounts[] = {1, 2, 7, 15, 16, 17, 31, 33, 63, 65, 100, 127, 321};
constexpr int kRadius = kSlopeRadius;

template <class Kernels>
const Kernels& baseline()
{
  return KernelTable<Kernels, InstructionSet::kBaseline>::table;
}

template <class T>
bool isSame(const std::vector<T>& a, const std::vector<T>& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

std::vector<float> reals(std::size_t count, double least, double most, std::uint64_t seed)
{
  cv::RNG random(seed);
  std::vector<float> numbers(count);
  for (float& number : numbers)
    number = static_cast<float>(random.uniform(least, most));
  return numbers;
}

template <class T>
std::vector<T> integers(std::size_t count, int most, std::uint64_t seed)
{
  cv::RNG random(seed);
  std::vector<T> numbers(count);
  for (T& number : numbers)
    number = static_cast<T>(random.uniform(0, most + 1));
  return numbers;
}

/// Rows of inverse depths of a surface with steps and holes, of which `count` numbers have kRadius beside them.
std::vector<std::vector<float>> surface(int count)
{
  cv::RNG random(static_cast<std::uint64_t>(count));
  std::vector<std::vector<float>> rows;
  for (int y = 0; y < 5; ++y)
  {
    rows.push_back(reals(static_cast<std::size_t>(count + 2 * kRadius), 0.0, 0.004, 5 + static_cast<std::uint64_t>(y)));
    for (std::size_t x = 0; x < rows.back().size(); ++x)
    {
      float& inverse = rows.back()[x];
      inverse +=
          1.0F + 0.002F * static_cast<float>(x) + 0.004F * static_cast<float>(y) + (x / 6 % 3 == 1 ? 0.3F : 0.0F);
      if (random.uniform(0, 9) == 0) inverse = 0.0F;
    }
  }
  return rows;
}

cv::Matx33d anyTurn(int number)
{
  return cv::Affine3d(cv::Vec3d(0.7 * number - 1.0, 0.4 * number, 0.2), cv::Vec3d()).rotation();
}

/// Windows around an image and its margin, as a matcher's frame has them.
struct Windows
{
  static constexpr int kMargin = 32, kWidth = 40, kHeight = 30, kStride = kWidth + 2 * kMargin + 1;

  explicit Windows(int count)
  {
    const std::size_t all = static_cast<std::size_t>(kStride) * (kHeight + 2 * kMargin + 1);
    bins = integers<std::uint32_t>(all * static_cast<std::size_t>(count), 0xFFFFFF, 1);
    const std::vector<int> near = integers<int>(bins.size(), 8000, 2), depth = integers<int>(bins.size(), 6000, 3);
    for (std::size_t i = 0; i < bins.size(); ++i)
    {
      const auto nearest = static_cast<std::uint32_t>(2000 + near[i]),
                 farthest = static_cast<std::uint32_t>(std::max(1, 2000 + near[i] - depth[i]));
      ranges.push_back(i % 7 == 0 ? kNoRange : farthest << 16 | nearest);
    }
    next = static_cast<int>(all);
  }

  const std::uint32_t* first(const std::vector<std::uint32_t>& of) const
  {
    return of.data() + kMargin * kStride + kMargin;
  }

  std::vector<std::uint32_t> bins, ranges;
  int next = 0;
};

/// The pixel nearest to a position, moved to the margin around the image.
int pixelOf(float position, int size)
{
  const float inside = std::min(std::max(position, -static_cast<float>(Windows::kMargin)), static_cast<float>(size));
  return static_cast<int>(std::floor(inside + 0.5F));
}

struct Looks
{
  Windows windows{1};
  std::vector<float> x = reals(kCodeFeatures, -0.1, 0.1, 11), y = reals(kCodeFeatures, -0.1, 0.1, 12),
                     z = reals(kCodeFeatures, -0.1, 0.1, 13);
  std::vector<std::uint16_t> code = integers<std::uint16_t>(kCodeFeatures, 143 * kCellBins, 14);
  LookFrame frame{windows.first(windows.bins),
                  windows.first(windows.ranges),
                  Windows::kStride,
                  Windows::kMargin,
                  Windows::kWidth,
                  Windows::kHeight,
                  40.0F,
                  41.0F,
                  20.3F,
                  14.8F,
                  4096.0F,
                  0.03F};

  Looks()
  {
    for (std::size_t i = 0; i < code.size(); ++i)  // as codes are: contours, then surfaces, twice
      code[i] = static_cast<std::uint16_t>(code[i] / kCellBins * kCellBins + code[i] % 8 +
                                           (i % (kCodeFeatures / 2) < kCodeContours / 2 ? 0 : 8));
  }

  static LookPose pose(int number)
  {
    LookPose pose;
    for (int i = 0; i < 9; ++i)
      pose.rotation[i] = static_cast<float>(anyTurn(number).val[i]);
    const float beside = number == 3 ? 2.0F : 0.02F * static_cast<float>(number);
    pose.anchor[0] = beside;
    pose.anchor[1] = number == 4 ? -3.0F : 0.01F;
    pose.anchor[2] = number == 5 ? 0.03F : 0.5F + 0.1F * static_cast<float>(number);
    return pose;
  }

  LookCounts plain(const LookPose& pose, bool with_depth) const
  {
    LookCounts counts{};
    for (std::size_t i = 0; i < kCodeFeatures; ++i)
    {
      float at[3];
      for (int k = 0; k < 3; ++k)
        at[k] = pose.rotation[3 * k] * x[i] + pose.rotation[3 * k + 1] * y[i] + pose.rotation[3 * k + 2] * z[i] +
                pose.anchor[k];
      const float inverse = 1.0F / std::max(at[2], 0.02F);
      const int u = pixelOf(at[0] * inverse * frame.fx + frame.cx, Windows::kWidth);
      const int v = pixelOf(at[1] * inverse * frame.fy + frame.cy, Windows::kHeight);
      const std::uint32_t bins = frame.bins[v * frame.stride + u], range = frame.ranges[v * frame.stride + u];
      const float expected = inverse * frame.inverse_steps, tolerance = frame.tolerance * inverse * expected;
      const bool hidden = with_depth && static_cast<float>(range >> 16) > expected + tolerance;
      const bool beyond = with_depth && !hidden && static_cast<float>(range & 0xFFFF) < expected - tolerance;
      const bool edge = i % (kCodeFeatures / 2) < kCodeContours / 2;
      const std::uint32_t bin = code[i] % kCellBins;
      if (hidden)
        ++(edge ? counts.hidden_edges : counts.hidden_surfaces);
      else if (beyond)
        ++(edge ? counts.edges_beyond : counts.surfaces_beyond);
      else if ((bins >> (bin + 8) & 1) != 0)
        ++(edge ? counts.depth_edges : counts.surfaces);
      else if (edge && (bins >> bin & 1) != 0)
        ++counts.image_edges;
    }
    return counts;
  }
};

std::vector<int> numbersOf(const LookCounts& counts)
{
  return {counts.depth_edges, counts.image_edges,     counts.hidden_edges,   counts.edges_beyond,
          counts.surfaces,    counts.hidden_surfaces, counts.surfaces_beyond};
}

}  // namespace

TEST(ViewKernels, projectPointsAndTheirNormals)
{
  for (const int count : kCounts)
  {
    const auto n = static_cast<std::size_t>(count);
    std::vector<std::vector<float>> from;
    for (std::uint64_t k = 0; k < 6; ++k)
      from.push_back(reals(n, k < 3 ? -0.2 : -1.0, k < 3 ? 0.2 : 1.0, 20 + k));
    const FitPoints points{from[0].data(), from[1].data(), from[2].data(),
                           from[3].data(), from[4].data(), from[5].data()};
    const FitCamera camera{100.0F, 110.0F, 31.5F, 23.5F, 64.0F, 48.0F};
    FitPose pose;
    for (int i = 0; i < 9; ++i)
      pose.rotation[i] = static_cast<float>(anyTurn(count).val[i]);
    const float anchor[3] = {0.05F, -0.02F, count % 3 == 0 ? 0.1F : 0.6F};
    std::copy_n(anchor, 3, pose.anchor);
    std::vector<std::vector<float>> seen[2];
    std::vector<std::int32_t> pixels[2][2];
    for (int k = 0; k < 2; ++k)
    {
      seen[k].assign(7, std::vector<float>(n));
      pixels[k][0].resize(n);
      pixels[k][1].resize(n);
      std::vector<std::vector<float>>& s = seen[k];
      const SeenPoints to{s[0].data(), s[1].data(), s[2].data(),         s[3].data(),        s[4].data(),
                          s[5].data(), s[6].data(), pixels[k][0].data(), pixels[k][1].data()};
      (k == 0 ? baseline<FitKernels>() : kernels<FitKernels>()).project(points, count, pose, camera, to);
    }
    for (std::size_t k = 0; k < 7; ++k)
      EXPECT_TRUE(isSame(seen[0][k], seen[1][k])) << count << " " << k;
    EXPECT_EQ(pixels[0][0], pixels[1][0]);
    EXPECT_EQ(pixels[0][1], pixels[1][1]);
    for (std::size_t i = 0; i < n; ++i)
    {
      const cv::Vec3d at =
          anyTurn(count) * cv::Vec3d(from[0][i], from[1][i], from[2][i]) + cv::Vec3d(anchor[0], anchor[1], anchor[2]);
      const cv::Vec3d normal = anyTurn(count) * cv::Vec3d(from[3][i], from[4][i], from[5][i]);
      for (std::size_t k = 0; k < 3; ++k)
      {
        EXPECT_NEAR(seen[1][k][i], at[static_cast<int>(k)], 1e-6);
        EXPECT_NEAR(seen[1][3 + k][i], normal[static_cast<int>(k)], 1e-6);
      }
      const double u = 100.0 * at[0] / at[2] + 31.5, v = 110.0 * at[1] / at[2] + 23.5;
      const bool inside = at[2] > 0.02 && u >= -0.5 && v >= -0.5 && u < 63.5 && v < 47.5;
      const double to_middle = std::max(std::abs(u - 31.5) - 32.0, std::abs(v - 23.5) - 24.0);
      if (std::abs(at[2] - 0.02) < 1e-4 || std::abs(to_middle) < 1e-2) continue;  // both may be right
      ASSERT_EQ(pixels[1][0][i] >= 0, inside) << u << " " << v << " " << at[2];
      if (!inside) continue;
      EXPECT_NEAR(pixels[1][0][i], u, 0.501);
      EXPECT_NEAR(pixels[1][1][i], v, 0.501);
      EXPECT_NEAR(seen[1][6][i] * at[2], 1.0, 1e-5);
    }
  }
}

TEST(ViewKernels, lookAtTemplatesAsPlainCodeDoes)
{
  const Looks looks;
  int sums[7] = {};
  for (int number = 0; number < 12; ++number)
    for (const bool with_depth : {true, false})
    {
      const LookPose pose = Looks::pose(number);
      const LookPoints points{looks.x.data(), looks.y.data(), looks.z.data()};
      LookCounts counts;
      const LookKernels& loops = kernels<LookKernels>();
      (with_depth ? loops.look : loops.look_at_image)(looks.frame, points, pose, looks.code.data(), counts);
      const std::vector<int> numbers = numbersOf(counts);
      EXPECT_EQ(numbers, numbersOf(looks.plain(pose, with_depth))) << number << " " << with_depth;
      for (std::size_t i = 0; i < numbers.size(); ++i)
        sums[i] += numbers[i];
    }
  for (const int sum : sums)
    EXPECT_GT(sum, 50);
}

TEST(ViewKernels, gatherTheCellsOfPlaces)
{
  const Windows windows(2);
  PlaceLanes lanes;
  cv::RNG random(6);
  for (int i = 0; i < kPlacesAtOnce; ++i)
  {
    lanes.x[i] = static_cast<float>(random.uniform(-50.0, 60.0));
    lanes.y[i] = static_cast<float>(random.uniform(-50.0, 50.0));
    lanes.across_x[i] = static_cast<float>(random.uniform(0.0, 4.0));
    lanes.across_y[i] = static_cast<float>(random.uniform(-1.0, 1.0));
    lanes.along_x[i] = static_cast<float>(random.uniform(-1.0, 1.0));
    lanes.along_y[i] = static_cast<float>(random.uniform(0.0, 4.0));
    lanes.window[i] = i % 2 * windows.next;
    lanes.least[i] = static_cast<std::uint32_t>(random.uniform(1000, 6000));
    lanes.most[i] = static_cast<std::uint32_t>(random.uniform(2000, 9000));
  }
  int scores[kDepthEdgeScore + 1] = {};
  for (const bool with_depth : {true, false})
    for (const auto& [column, row] : {std::pair(0, 0), std::pair(3, 11), std::pair(11, 2)})
    {
      const SearchedFrame frame{windows.first(windows.bins),
                                with_depth ? windows.first(windows.ranges) : nullptr,
                                Windows::kStride,
                                Windows::kMargin,
                                Windows::kWidth,
                                Windows::kHeight};
      std::vector<std::uint8_t> planes(kCellBins * kPlacesAtOnce);
      kernels<SearchKernels>().gather(frame, lanes, column, row, planes.data());
      for (int i = 0; i < kPlacesAtOnce; ++i)
      {
        const auto c = static_cast<float>(column), r = static_cast<float>(row);
        const int u = pixelOf(lanes.x[i] + c * lanes.across_x[i] + r * lanes.along_x[i], Windows::kWidth);
        const int v = pixelOf(lanes.y[i] + c * lanes.across_y[i] + r * lanes.along_y[i], Windows::kHeight);
        const int at = lanes.window[i] + v * Windows::kStride + u;
        std::uint32_t bins = frame.bins[at];
        const std::uint32_t range = with_depth ? frame.ranges[at] : 0;
        if (with_depth && range == kNoRange)
          bins &= 0xFF;
        else if (with_depth && ((range & 0xFFFF) < lanes.least[i] || range >> 16 > lanes.most[i]))
          bins = 0;
        for (int bin = 0; bin < 8; ++bin)
        {
          const bool edge = (bins >> bin & 1) != 0, depth_edge = (bins >> (bin + 8) & 1) != 0;
          const int of_depth = with_depth ? kDepthEdgeScore : kOnlyEdgeScore;
          const int expected = depth_edge ? of_depth : edge ? kImageEdgeScore : 0;
          ASSERT_EQ(planes[static_cast<std::size_t>(bin * kPlacesAtOnce + i)], expected) << i << " " << bin;
          const int surface = (bins >> (bin + 16) & 1) != 0 ? kSurfaceScore : 0;
          ASSERT_EQ(planes[static_cast<std::size_t>((bin + 8) * kPlacesAtOnce + i)], surface) << i << " " << bin;
          ++scores[expected];
        }
      }
    }
  for (const int score : scores)
    EXPECT_GT(score, 200);
}

TEST(ViewKernels, tellPlacesAboveTheirFloors)
{
  constexpr std::size_t kPlanes = 40;
  std::vector<std::uint8_t> planes(kPlanes * kPlacesAtOnce);
  cv::RNG random(9);
  for (std::size_t i = 0; i < planes.size(); ++i)
    planes[i] = static_cast<std::uint8_t>(i / kPlacesAtOnce % 2 == 0 ? 3 * random.uniform(0, 2) : random.uniform(0, 2));
  int above = 0, none = 0, unlikely = 0;
  for (std::uint64_t round = 0; round < 200; ++round)
  {
    std::vector<std::uint16_t> code = integers<std::uint16_t>(kCodeFeatures, kPlanes / 2 - 1, 30 + round);
    for (std::size_t i = 0; i < code.size(); ++i)  // each half has half of each kind
      code[i] = static_cast<std::uint16_t>(2 * code[i] + (i % (kCodeFeatures / 2) < kCodeContours / 2 ? 0 : 1));
    std::vector<std::uint8_t> floors = integers<std::uint8_t>(kPlacesAtOnce, 80, 500 + round), scores(kPlacesAtOnce, 7);
    for (std::uint8_t& floor : floors)
      floor = static_cast<std::uint8_t>(round % 4 == 0 ? 255 : 85 + floor);
    if (round % 8 == 0) floors[round % kPlacesAtOnce] = 60;
    std::uint64_t expected = 0;
    std::vector<std::uint8_t> sums(kPlacesAtOnce);
    for (int i = 0; i < kPlacesAtOnce; ++i)
    {
      int sum = 0, half = 0;
      for (std::size_t f = 0; f < code.size(); ++f)
      {
        sum += planes[static_cast<std::size_t>(code[f] * kPlacesAtOnce + i)];
        if (f + 1 == code.size() / 2) half = sum;
      }
      sums[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(sum);
      const int floor = floors[static_cast<std::size_t>(i)];
      unlikely += sum > floor && 2 * half <= floor ? 1 : 0;
      expected |= std::uint64_t{sum > floor && 2 * half > floor ? 1U : 0U} << i;
    }
    ASSERT_EQ(kernels<SearchKernels>().above(planes.data(), code.data(), floors.data(), scores.data()), expected);
    ++(expected != 0 ? above : none);
    if (expected != 0)
    {
      EXPECT_EQ(scores, sums);
    }
  }
  EXPECT_GT(above, 50);
  EXPECT_GT(none, 20);
  EXPECT_GT(unlikely, 20);
}

TEST(ViewKernels, doNotCountBeyondTheLargestByte)
{
  const std::vector<std::uint8_t> planes(kPlacesAtOnce, kDepthEdgeScore);
  const std::vector<std::uint16_t> code(kCodeFeatures, 0);  // as of a view without surfaces: its score would be 288
  std::vector<std::uint8_t> floors(kPlacesAtOnce, 254), scores(kPlacesAtOnce, 7);
  const auto above = kernels<SearchKernels>().above;
  EXPECT_EQ(above(planes.data(), code.data(), floors.data(), scores.data()), ~std::uint64_t{0});
  EXPECT_EQ(scores, std::vector<std::uint8_t>(kPlacesAtOnce, 255));
  floors.assign(kPlacesAtOnce, 255);
  EXPECT_EQ(above(planes.data(), code.data(), floors.data(), scores.data()), 0U);
}

TEST(FrameKernels, makeInverseDepths)
{
  for (const int count : kCounts)
  {
    const auto n = static_cast<std::size_t>(count);
    const std::vector<std::uint16_t> millimetres = integers<std::uint16_t>(n, 1500, 3);
    std::vector<float> metres = reals(n, -0.5, 4.0, 4), inverses(n);
    const float odd[] = {NAN, INFINITY, -INFINITY, 0.0F, 1e-30F, 1e30F};
    for (std::size_t i = 0; i < n; i += 3)
      metres[i] = odd[i / 3 % 6];
    kernels<FrameKernels>().inverses_of_millimetres(millimetres.data(), count, inverses.data());
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_FLOAT_EQ(inverses[i], millimetres[i] == 0 ? 0.0F : 1000.0F / static_cast<float>(millimetres[i]));
    kernels<FrameKernels>().inverses_of_metres(metres.data(), count, inverses.data());
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_FLOAT_EQ(inverses[i], metres[i] >= 1e-3F && metres[i] <= 1e3F ? 1.0F / metres[i] : 0.0F) << metres[i];
  }
}

TEST(FrameKernels, measureDepthsAsTheBaselineDoes)
{
  for (const int count : kCounts)
  {
    const auto n = static_cast<std::size_t>(count);
    const std::vector<std::vector<float>> surfaces = surface(count);
    const float* rows[5];
    for (std::size_t y = 0; y < 5; ++y)
      rows[y] = surfaces[y].data() + kRadius;
    const std::vector<float> x = reals(n, -0.6, 0.6, 1), lengths = reals(n, 0.7, 1.0, 2);
    const RayGeometry rays{x.data(), lengths.data(), 0.2F, 262.0F, 263.0F};
    std::vector<float> across[2], along[2];
    std::vector<std::uint8_t> bins[2], edges[2];
    std::vector<std::uint32_t> ranges[2];
    for (int k = 0; k < 2; ++k)
    {
      const FrameKernels& loops = k == 0 ? baseline<FrameKernels>() : kernels<FrameKernels>();
      across[k].resize(n);
      along[k].resize(n);
      bins[k].resize(n);
      edges[k].resize(n);
      ranges[k].resize(n);
      const SlopeRow slopes{across[k].data(), along[k].data(), bins[k].data()};
      loops.slopes(rows, rays, count, slopes);
      loops.depth_edges(rows, rays, slopes, 0.01F, count, edges[k].data());
      loops.ranges(rows[2], 4096.0F, count, ranges[k].data());
    }
    EXPECT_TRUE(isSame(across[0], across[1])) << count;
    EXPECT_TRUE(isSame(along[0], along[1])) << count;
    EXPECT_EQ(bins[0], bins[1]) << count;
    EXPECT_EQ(edges[0], edges[1]) << count;
    EXPECT_EQ(ranges[0], ranges[1]) << count;
    for (std::size_t i = 0; i < n; ++i)
    {
      const auto code = static_cast<std::uint32_t>(rows[2][i] * 4096.0F + 0.5F);
      EXPECT_EQ(ranges[1][i], rows[2][i] > 0.0F ? code << 16 | code : kNoRange);
    }
    if (count < 100) continue;
    EXPECT_GT(std::count_if(bins[1].begin(), bins[1].end(), [](int bin) { return bin != 0; }), count / 4);
    EXPECT_GT(std::count_if(edges[1].begin(), edges[1].end(), [](int bin) { return bin != 0; }), count / 20);
  }
}

TEST(FrameKernels, takeTheNearestSurfaceOfASquare)
{
  for (const int count : kCounts)
    for (int block = 1; block <= kMaxBlock; ++block)
    {
      std::vector<std::vector<float>> from;
      const float* rows[kMaxBlock];
      for (int k = 0; k < block; ++k)
        from.push_back(reals(static_cast<std::size_t>(count * block), 0.0, 1.0, 50 + static_cast<std::uint64_t>(k)));
      for (int k = 0; k < block; ++k)
      {
        for (std::size_t i = 0; i < from[static_cast<std::size_t>(k)].size(); ++i)
          if (i % 9 < 4) from[static_cast<std::size_t>(k)][i] = i % 9 < 2 ? 0.0F : 0.99F;
        rows[k] = from[static_cast<std::size_t>(k)].data();
      }
      std::vector<float> nearest(static_cast<std::size_t>(count)), before(nearest.size());
      kernels<FrameKernels>().nearest[block - 1](rows, count, nearest.data());
      baseline<FrameKernels>().nearest[block - 1](rows, count, before.data());
      EXPECT_TRUE(isSame(nearest, before));
      for (int i = 0; i < count; ++i)
      {
        float largest = 0.0F;
        for (int k = 0; k < block * block; ++k)
          largest = std::max(largest, rows[k / block][i * block + k % block]);
        EXPECT_LE(nearest[static_cast<std::size_t>(i)], largest * 1.00001F);
        EXPECT_GE(nearest[static_cast<std::size_t>(i)], largest * (0.99999F - kOneSurface));
      }
    }
}

TEST(FrameKernels, findEdgesAsTheBaselineDoes)
{
  for (const int count : kCounts)
    for (const int channels : {1, 3})
    {
      const auto n = static_cast<std::size_t>(count);
      std::vector<std::uint8_t> pixels[3][3];
      ChannelRows rows{{}, {}, {}, channels};
      for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c)
      {
        for (std::size_t y = 0; y < 3; ++y)
          pixels[c][y] = integers<std::uint8_t>(n + 2, c == 1 ? 255 : 90, 60 + 3 * c + y);
        rows.above[c] = pixels[c][0].data() + 1;
        rows.row[c] = pixels[c][1].data() + 1;
        rows.below[c] = pixels[c][2].data() + 1;
      }
      std::vector<std::int16_t> magnitudes[2];
      std::vector<std::uint8_t> octants[2], bins[2];
      for (int k = 0; k < 2; ++k)
      {
        const FrameKernels& loops = k == 0 ? baseline<FrameKernels>() : kernels<FrameKernels>();
        magnitudes[k].resize(n);
        octants[k].resize(n);
        bins[k].resize(n);
        loops.gradients(rows, count, {magnitudes[k].data(), octants[k].data()});
        const std::vector<std::int16_t> above = integers<std::int16_t>(n + 2, 500, 70),
                                        row = integers<std::int16_t>(n + 2, 500, 71),
                                        below = integers<std::int16_t>(n + 2, 500, 72);
        const std::vector<std::uint8_t> of_row = integers<std::uint8_t>(n, 15, 73);
        loops.edges(above.data() + 1, row.data() + 1, below.data() + 1, of_row.data(), 200, count, bins[k].data());
        for (std::size_t i = 0; i < n; ++i)
          if (bins[k][i] != 0)
          {
            EXPECT_GE(row[i + 1], 200);
          }
      }
      EXPECT_EQ(magnitudes[0], magnitudes[1]);
      EXPECT_EQ(octants[0], octants[1]);
      EXPECT_EQ(bins[0], bins[1]);
      for (std::size_t i = 0; i < n; ++i)
      {
        double longest = 0.0;
        for (int c = 0; c < channels; ++c)
        {
          const std::uint8_t *a = rows.above[c] + i, *r = rows.row[c] + i, *b = rows.below[c] + i;
          longest = std::max(longest, std::hypot(a[1] - a[-1] + 2.0 * (r[1] - r[-1]) + b[1] - b[-1],
                                                 b[-1] - a[-1] + 2.0 * (b[0] - a[0]) + b[1] - a[1]));
        }
        EXPECT_NEAR(magnitudes[1][i], longest, 0.08 * longest + 1.0);
      }
    }
}

TEST(FrameKernels, uniteBinsAndRanges)
{
  for (const int count : kCounts)
    for (const int shift : {1, 2, 8})
    {
      const auto n = static_cast<std::size_t>(count), all = n + static_cast<std::size_t>(shift);
      const std::vector<std::uint32_t> row = integers<std::uint32_t>(all, 0x7FFFFFFE, 1),
                                       other = integers<std::uint32_t>(all, 0x7FFFFFFE, 2);
      std::vector<std::uint32_t> united(n), widened(n), joined(n);
      kernels<FrameKernels>().unite(row.data(), other.data(), shift, count, united.data());
      kernels<FrameKernels>().widen(row.data(), other.data(), shift, count, widened.data());
      const std::vector<std::uint8_t> a = integers<std::uint8_t>(n, 255, 3), b = integers<std::uint8_t>(n, 255, 4),
                                      c = integers<std::uint8_t>(n, 255, 5);
      kernels<FrameKernels>().join(a.data(), b.data(), c.data(), count, joined.data());
      for (std::size_t i = 0; i < n; ++i)
      {
        const std::uint32_t four[] = {row[i], row[i + static_cast<std::size_t>(shift)], other[i],
                                      other[i + static_cast<std::size_t>(shift)]};
        std::uint32_t bins = 0, near = 0, far = 0xFFFF;
        for (const std::uint32_t one : four)
        {
          bins |= one;
          near = std::max(near, one & 0xFFFF);
          far = std::min(far, one >> 16);
        }
        ASSERT_EQ(united[i], bins);
        ASSERT_EQ(widened[i], far << 16 | near);
        ASSERT_EQ(joined[i], a[i] | b[i] << 8 | static_cast<std::uint32_t>(c[i]) << 16);
      }
    }
}
