#include "observed_frame.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/simd/kernel_tables.hpp"
#include "frame_kernels.hpp"

namespace robot_vision
{
namespace
{

const FrameKernels& loops()
{
  return kernels<FrameKernels>();
}

/// Fills what is beside the image with what is at its border: there is no edge at it.
void repeatBorder(PaddedImage<std::uint8_t>& image)
{
  const auto [width, height] = std::make_pair(image.size().width, image.size().height);
  for (int y = 0; y < height; ++y)
  {
    image[y][-1] = image[y][0];
    image[y][width] = image[y][width - 1];
  }
  std::copy_n(image[0] - 1, width + 2, image[-1] - 1);
  std::copy_n(image[height - 1] - 1, width + 2, image[height] - 1);
}

/// Edges of depth at the border of the image may be those of the image.
void clearBorder(PaddedImage<std::uint8_t>& bins)
{
  const auto [width, height] = std::make_pair(bins.size().width, bins.size().height);
  for (int y = 0; y < height; ++y)
  {
    const bool inside = y >= kSlopeRadius && y < height - kSlopeRadius;
    const int margin = inside ? std::min(kSlopeRadius, width) : width;
    std::fill_n(bins[y], margin, std::uint8_t{0});
    std::fill_n(bins[y] + width - margin, margin, std::uint8_t{0});
  }
}

/// Fills gaps between two depths of a row with the farther one: what a surface lacks here and there, and what is beside
/// a thing in the shadow that it casts for a sensor with a projector. Wider gaps stay.
void fillGaps(const float* inverses, int count, float* filled)
{
  constexpr int kWidest = 24;  // px
  int last = -1;               // the last one with a depth
  for (int x = 0; x < count; ++x)
  {
    filled[x] = inverses[x];
    if (inverses[x] == 0.0F) continue;
    if (last >= 0 && x - last - 1 <= kWidest)
      std::fill(filled + last + 1, filled + x, std::min(filled[last], filled[x]));
    last = x;
  }
}

/// Combines each pixel with those around it until squares of kWindows[i] px are combined.
template <class Combine>
void enlarge(const Combine& combine, const cv::Size& size, PaddedImages<std::uint32_t>& images)
{
  for (std::size_t i = 1; i < kWindows.size(); ++i)
  {
    const auto smaller = images[i - 1], larger = images[i];
    const int shift = kWindows[i] - kWindows[i - 1], before = kWindows[i] - 1;
    for (int y = -before; y < size.height; ++y)
      combine(smaller[y] - before, smaller[y + shift] - before, shift, size.width + before, larger[y] - before);
  }
}

}  // namespace

void ObservedFrame::observe(const ViewCamera& camera, const cv::Mat& bgr, const cv::Mat& depth,
                            const EdgeLimits& limits)
{
  size_ = camera.size();
  has_depth_ = !depth.empty();
  for (auto* image : {&inverses_, &filled_, &across_, &along_})
    image->create(size_);
  for (auto* image : {&edges_, &depth_edges_, &surfaces_, &octants_})
    image->create(size_);
  magnitudes_.create(size_);
  bins_.create(size_, static_cast<int>(kWindows.size()));
  if (ranges_.create(size_, static_cast<int>(kWindows.size()))) ranges_.fill(kNoRange);
  observeDepth(camera, depth, limits);
  observeImage(camera, bgr, limits);
  unite();
}

void ObservedFrame::observeDepth(const ViewCamera& camera, const cv::Mat& depth, const EdgeLimits& limits)
{
  if (!has_depth_)
  {
    inverses_.fill(0.0F);
    surfaces_.fill(0);
    return;
  }
  reduceDepth(camera, depth);
  for (int y = 0; y < size_.height; ++y)
    fillGaps(inverses_[y], size_.width, filled_[y]);
  for (int y = 0; y < size_.height; ++y)
  {
    const float* const rows[] = {inverses_[y - 2], inverses_[y - 1], inverses_[y], inverses_[y + 1], inverses_[y + 2]};
    const RayGeometry rays{camera.rayX(), camera.inverseLengths(y), camera.rayY(y), static_cast<float>(camera.fx()),
                           static_cast<float>(camera.fy())};
    const SlopeRow slopes{across_[y], along_[y], surfaces_[y]};
    loops().slopes(rows, rays, size_.width, slopes);
    const float* const filled[] = {filled_[y - 2], filled_[y - 1], filled_[y], filled_[y + 1], filled_[y + 2]};
    loops().depth_edges(filled, rays, slopes, limits.jump, size_.width, depth_edges_[y]);
    for (int x = 0; x < size_.width; ++x)
      if (inverses_[y][x] == 0.0F) depth_edges_[y][x] = 0;
  }
  clearBorder(depth_edges_);
}

void ObservedFrame::reduceDepth(const ViewCamera& camera, const cv::Mat& depth)
{
  const int block = camera.block(), used = std::min(block, kMaxBlock), step = block / used;
  full_rows_.resize(used, std::max(depth.cols, used * size_.width));
  const bool bent = !camera.places().empty();
  if (bent) reduced_.create(size_, CV_32FC1);
  const float* rows[kMaxBlock];
  for (int y = 0; y < size_.height; ++y)
  {
    for (int k = 0; k < used; ++k)
    {
      const int from = y * block + k * step;
      if (depth.type() == CV_16UC1)
        loops().inverses_of_millimetres(depth.ptr<std::uint16_t>(from), depth.cols, full_rows_[k]);
      else
        loops().inverses_of_metres(depth.ptr<float>(from), depth.cols, full_rows_[k]);
      if (used < block)  // takes some of the pixels of a very large image
        for (int x = 0; x < used * size_.width; ++x)
          full_rows_[k][x] = full_rows_[k][x / used * block + x % used * step];
      rows[k] = full_rows_[k];
    }
    loops().nearest[used - 1](rows, size_.width, bent ? reduced_.ptr<float>(y) : inverses_[y]);
  }
  if (!bent) return;
  cv::remap(reduced_, moved_inverses_, camera.places(), cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  for (int y = 0; y < size_.height; ++y)
    std::copy_n(moved_inverses_.ptr<float>(y), size_.width, inverses_[y]);
}

void ObservedFrame::observeImage(const ViewCamera& camera, const cv::Mat& bgr, const EdgeLimits& limits)
{
  if (bgr.empty())
  {
    edges_.fill(0);
    return;
  }
  reduceImage(camera, bgr);
  ChannelRows rows{{}, {}, {}, static_cast<int>(planes_.size())};
  for (int y = 0; y < size_.height; ++y)
  {
    for (int c = 0; c < rows.channels; ++c)
    {
      PaddedImage<std::uint8_t>& channel = channels_[static_cast<std::size_t>(c)];
      rows.above[c] = channel[y - 1];
      rows.row[c] = channel[y];
      rows.below[c] = channel[y + 1];
    }
    loops().gradients(rows, size_.width, {magnitudes_[y], octants_[y]});
  }
  constexpr int kSobel = 4;  // the magnitude of a step by one gray level
  for (int y = 0; y < size_.height; ++y)
    loops().edges(magnitudes_[y - 1], magnitudes_[y], magnitudes_[y + 1], octants_[y], kSobel * limits.contrast,
                  size_.width, edges_[y]);
}

void ObservedFrame::reduceImage(const ViewCamera& camera, const cv::Mat& bgr)
{
  const int block = camera.block();
  const cv::Mat whole = bgr(cv::Rect(0, 0, size_.width * block, size_.height * block));
  cv::Mat small = whole;
  if (block > 1)
  {
    cv::resize(whole, reduced_image_, size_, 0.0, 0.0, cv::INTER_AREA);
    small = reduced_image_;
  }
  if (!camera.places().empty())
  {
    cv::remap(small, moved_, camera.places(), cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    small = moved_;
  }
  cv::split(small, planes_);
  for (std::size_t c = 0; c < planes_.size(); ++c)
  {
    channels_[c].create(size_);
    for (int y = 0; y < size_.height; ++y)
      std::copy_n(planes_[c].ptr(y), size_.width, channels_[c][y]);
    repeatBorder(channels_[c]);
  }
}

void ObservedFrame::unite()
{
  for (int y = 0; y < size_.height; ++y)
  {
    loops().join(edges_[y], has_depth_ ? depth_edges_[y] : edges_[y], surfaces_[y], size_.width, bins_[0][y]);
    if (has_depth_) loops().ranges(inverses_[y], kInverseSteps, size_.width, ranges_[0][y]);
  }
  enlarge(loops().unite, size_, bins_);
  if (has_depth_) enlarge(loops().widen, size_, ranges_);
  sumEdges();
}

void ObservedFrame::sumEdges()
{
  const PaddedImage<std::uint8_t>& edges = has_depth_ ? depth_edges_ : edges_;
  edge_sums_.create(size_.height + 1, size_.width + 1, CV_32SC1);
  edge_sums_.row(0).setTo(0);
  for (int y = 0; y < size_.height; ++y)
  {
    const int* const above = edge_sums_.ptr<int>(y);
    int* const sums = edge_sums_.ptr<int>(y + 1);
    int sum = sums[0] = 0;
    for (int x = 0; x < size_.width; ++x)
    {
      sum += edges[y][x] != 0 ? 1 : 0;
      sums[x + 1] = above[x + 1] + sum;
    }
  }
}

}  // namespace robot_vision
