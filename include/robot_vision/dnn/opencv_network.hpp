#pragma once

#include <cstdint>
#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

/// A network that OpenCV's module dnn runs, read from the content of its files. It belongs to one thread at a time.
/// What OpenCV throws is thrown as std::invalid_argument, with OpenCV's words; nothing is printed.
class OpenCvNetwork
{
public:
  using Bytes = std::vector<std::uint8_t>;

  /// `kind` is onnx, darknet, caffe or tensorflow. `description` is the second file of those that have two, as .cfg and
  /// .prototxt; empty if there is none. Throws std::invalid_argument for what OpenCV cannot read.
  OpenCvNetwork(const std::string& kind, const Bytes& data, const Bytes& description);

  /// Of the layers that no other uses, as this version of OpenCV names them.
  std::vector<std::string> outputNames() const;

  /// The values of layers for an input, CV_32F of four dimensions; each has memory of its own.
  std::vector<cv::Mat> forward(const cv::Mat& input, const std::vector<std::string>& names);

  /// Floating point operations of a run as OpenCV counts them, for an input of this shape.
  std::int64_t flop(const std::vector<int>& shape) const;

private:
  mutable cv::dnn::Net net_;
};

}  // namespace robot_vision
