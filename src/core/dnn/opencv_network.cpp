#include "robot_vision/dnn/opencv_network.hpp"

#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <stdexcept>

namespace robot_vision
{
namespace
{

namespace logging = cv::utils::logging;

/// Keeps OpenCV from printing errors that it throws as well. The level is one for all threads.
class QuietOpenCv
{
public:
  QuietOpenCv()
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (count++ == 0) before = logging::setLogLevel(logging::LOG_LEVEL_SILENT);
  }
  ~QuietOpenCv()
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (--count == 0) logging::setLogLevel(before);
  }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

private:
  static inline std::mutex mutex;  // guards both
  static inline int count = 0;
  static inline logging::LogLevel before;  // the first of all that are there
};

/// What `work` returns; exceptions of OpenCV, which lets those of other libraries through, as std::invalid_argument.
template <class Work>
auto inItsWords(const Work& work)
{
  const QuietOpenCv quiet;
  try
  {
    return work();
  }
  catch (const cv::Exception& error)
  {
    throw std::invalid_argument(error.err.empty() ? error.what() : error.err);
  }
  catch (const std::exception& error)
  {
    throw std::invalid_argument(error.what());
  }
}

cv::dnn::Net read(const std::string& kind, const OpenCvNetwork::Bytes& data, const OpenCvNetwork::Bytes& description)
{
  if (kind == "onnx") return cv::dnn::readNetFromONNX(data);
  if (kind == "darknet") return cv::dnn::readNetFromDarknet(description, data);
  if (kind == "caffe") return cv::dnn::readNetFromCaffe(description, data);
  if (kind == "tensorflow") return cv::dnn::readNetFromTensorflow(data, description);
  throw std::invalid_argument("kind is " + kind + ", must be onnx, darknet, caffe or tensorflow");
}

}  // namespace

OpenCvNetwork::OpenCvNetwork(const std::string& kind, const Bytes& data, const Bytes& description)
  : net_(inItsWords([&] { return read(kind, data, description); }))
{
}

std::vector<std::string> OpenCvNetwork::outputNames() const
{
  return inItsWords([&] { return std::vector<std::string>(net_.getUnconnectedOutLayersNames()); });
}

std::vector<cv::Mat> OpenCvNetwork::forward(const cv::Mat& input, const std::vector<std::string>& names)
{
  return inItsWords(
      [&]
      {
        std::vector<cv::Mat> outputs;
        net_.setInput(input);
        net_.forward(outputs, names);
        for (cv::Mat& output : outputs)
          output = output.clone();  // the network's own memory has other values after the next run
        return outputs;
      });
}

std::int64_t OpenCvNetwork::flop(const std::vector<int>& shape) const
{
  return inItsWords([&] { return net_.getFLOPS(shape); });
}

}  // namespace robot_vision
