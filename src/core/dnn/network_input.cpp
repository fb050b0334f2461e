#include "robot_vision/dnn/network_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/image/aligned_rows.hpp"
#include "core/image/rects.hpp"
#include "input_kernels.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxStatistic = 1e6;  // of a mean and of a std: what is computed with them stays finite

/// Where the resized part of the image is in the input.
cv::Rect placeOf(const cv::Size& part, const InputParams& params)
{
  const cv::Size input(params.width, params.height);
  if (params.fit == "stretch") return {{0, 0}, input};
  const double scale =
      std::min(static_cast<double>(input.width) / part.width, static_cast<double>(input.height) / part.height);
  const auto side = [scale](int length, int limit)
  { return std::clamp(static_cast<int>(std::lround(length * scale)), 1, limit); };
  const cv::Size size(side(part.width, input.width), side(part.height, input.height));
  if (params.fit == "corner") return {{0, 0}, size};
  return {{(input.width - size.width) / 2, (input.height - size.height) / 2}, size};
}

/// Where the pixels of a resized side are between those of the side that it is made of.
struct Samples
{
  Samples(int from, int to) : first(static_cast<std::size_t>(to)), share(first.size())
  {
    const double step = static_cast<double>(from) / to;
    for (int i = 0; i < to; ++i)
    {
      const double at = std::max(0.0, (i + 0.5) * step - 0.5);
      const int begin = std::min(static_cast<int>(at), from - 1);
      first[static_cast<std::size_t>(i)] = begin;
      share[static_cast<std::size_t>(i)] = begin == from - 1 ? 0.0F : static_cast<float>(at - begin);
    }
  }

  std::vector<std::int32_t> first;
  std::vector<float> share;
};

/// value * factor + offset of each channel, in the network's order.
struct Normalisation
{
  explicit Normalisation(const InputParams& params)
  {
    for (std::size_t c = 0; c < 3; ++c)
    {
      factor[c] = static_cast<float>(1.0 / params.std[c]);
      offset[c] = static_cast<float>(-params.mean[c] / params.std[c]);
      pad[c] = static_cast<float>(params.pad) * factor[c] + offset[c];
    }
  }

  std::array<float, 3> factor, offset, pad;
};

std::vector<int> shapeOf(const InputParams& params)
{
  if (params.layout == "nchw") return {1, 3, params.height, params.width};
  return {1, params.height, params.width, 3};
}

void checkOutput(const cv::Mat& out, const InputParams& params)
{
  const std::vector<int> shape = shapeOf(params);
  bool fits = out.type() == CV_32F && out.dims == 4 && out.isContinuous();
  for (int i = 0; fits && i < 4; ++i)
    fits = out.size[i] == shape[static_cast<std::size_t>(i)];
  std::vector<std::string> expected, seen;
  for (int i = 0; i < 4; ++i)
    expected.push_back(std::to_string(shape[static_cast<std::size_t>(i)]));
  for (int i = 0; i < out.dims; ++i)
    seen.push_back(std::to_string(out.size[i]));
  require(fits, "out", "(" + joined(seen) + ")", "float32 of (" + joined(expected) + ") without gaps");
}

/// Writes the rows of one input.
class InputWriter
{
public:
  InputWriter(const InputParams& params, float* out)
    : params_(params), normal_(params), planar_(params.layout == "nchw"), is_rgb_(params.order == "rgb"), out_(out)
  {
  }

  /// Pads columns from `begin` to `end` of a row.
  void pad(int row, int begin, int end)
  {
    for (int c = 0; c < 3; ++c)
    {
      const float value = normal_.pad[static_cast<std::size_t>(c)];
      if (planar_)
        std::fill(at(row, begin, c), at(row, begin, c) + (end - begin), value);
      else
        for (int i = begin; i < end; ++i)
          *at(row, i, c) = value;
    }
  }

  /// Resamples the channels of a row, in the image's order, from column `begin` on.
  void write(AlignedRows<float>& channels, const Samples& columns, int row, int begin)
  {
    const auto count = static_cast<int>(columns.first.size());
    if (!planar_) resampled_.resize(3, count);
    for (int c = 0; c < 3; ++c)
    {
      const auto i = static_cast<std::size_t>(c);
      float* const to = planar_ ? at(row, begin, c) : resampled_[c];
      kernels_.blend_columns(channels[is_rgb_ ? 2 - c : c], {columns.first.data(), columns.share.data()}, count,
                             normal_.factor[i], normal_.offset[i], to);
    }
    if (!planar_) kernels_.interleave(resampled_[0], resampled_[1], resampled_[2], count, at(row, begin, 0));
  }

private:
  float* at(int row, int column, int channel) const
  {
    const std::ptrdiff_t width = params_.width, height = params_.height;
    return out_ + (planar_ ? (channel * height + row) * width + column : (row * width + column) * 3 + channel);
  }

  const InputParams& params_;
  const Normalisation normal_;
  const InputKernels& kernels_ = kernels<InputKernels>();
  const bool planar_, is_rgb_;
  float* const out_;
  AlignedRows<float> resampled_;
};

}  // namespace

void validate(const InputParams& params)
{
  checkFields(params);
  for (const double mean : params.mean)
    requireRange("mean", mean, -kMaxStatistic, kMaxStatistic);
  for (const double std : params.std)
    requireRange("std", std, 1.0 / kMaxStatistic, kMaxStatistic);
}

InputPlacement fillInput(const cv::Mat& bgr, const cv::Rect& part, const InputParams& params, cv::Mat& out)
{
  validate(params);
  checkPixels(bgr, "bgr8", CV_8UC3);
  requireInside(part, bgr.size());
  checkOutput(out, params);

  const cv::Rect place = placeOf(part.size(), params);
  const Samples columns(part.width, place.width), rows(part.height, place.height);
  const InputKernels& kernel = kernels<InputKernels>();
  InputWriter writer(params, out.ptr<float>());
  AlignedRows<float> channels;
  channels.resize(3, part.width + kInputMargin);
  channels.fill(0.0F);  // what is read behind the last column counts for nothing, but must be a number
  const cv::Mat image = bgr(part);
  for (int y = 0; y < params.height; ++y)
  {
    const int i = y - place.y;
    if (i < 0 || i >= place.height)
    {
      writer.pad(y, 0, params.width);
      continue;
    }
    const int above = rows.first[static_cast<std::size_t>(i)], below = std::min(above + 1, part.height - 1);
    kernel.blend_rows(image.ptr(above), image.ptr(below), rows.share[static_cast<std::size_t>(i)], part.width,
                      channels[0], channels[1], channels[2]);
    writer.pad(y, 0, place.x);
    writer.write(channels, columns, y, place.x);
    writer.pad(y, place.br().x, params.width);
  }
  return {static_cast<double>(place.width) / part.width,
          static_cast<double>(place.height) / part.height,
          static_cast<double>(place.x),
          static_cast<double>(place.y),
          part.x,
          part.y};
}

}  // namespace robot_vision
