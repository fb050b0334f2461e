#include <pybind11/stl.h>

#include <cstring>
#include <string_view>

#include "arrays.hpp"
#include "leave_gil.hpp"
#include "registry.hpp"
#include "robot_vision/dnn/opencv_network.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace dnn_network_bindings
{

using Input = py::array_t<float, py::array::c_style>;

OpenCvNetwork::Bytes bytesOf(const py::bytes& data)
{
  const auto view = data.cast<std::string_view>();
  return {view.begin(), view.end()};
}

std::unique_ptr<OpenCvNetwork> makeNetwork(const std::string& kind, const py::bytes& data, const py::bytes& description)
{
  const OpenCvNetwork::Bytes content = bytesOf(data), other = bytesOf(description);
  const LeaveGil unlocked;
  return std::make_unique<OpenCvNetwork>(kind, content, other);
}

/// A copy of a Mat of one channel and any number of dimensions.
py::array copyOf(const cv::Mat& mat)
{
  py::array array(sampleType(mat.depth()), std::vector<py::ssize_t>(mat.size.p, mat.size.p + mat.dims));
  std::memcpy(array.mutable_data(), mat.data, mat.total() * mat.elemSize());
  return array;
}

std::vector<py::array> forward(OpenCvNetwork& network, const Input& values, const std::vector<std::string>& names)
{
  const std::vector<int> shape(values.shape(), values.shape() + values.ndim());
  const cv::Mat input(static_cast<int>(shape.size()), shape.data(), CV_32F, const_cast<float*>(values.data()));
  const std::vector<cv::Mat> outputs = withoutGil([&] { return network.forward(input, names); });
  std::vector<py::array> arrays;
  arrays.reserve(outputs.size());
  for (const cv::Mat& output : outputs)
    arrays.push_back(copyOf(output));
  return arrays;
}

void bindNetwork(py::module& m)
{
  py::class_<OpenCvNetwork>(m, "OpenCvNetwork",
                            "A network that OpenCV's module dnn runs; it belongs to one thread at a time.")
      .def(py::init(&makeNetwork), "kind"_a, "data"_a, "description"_a = py::bytes(),
           "Of the content of its files: kind is onnx, darknet, caffe or tensorflow, description the second file of "
           "those that have two.\n\nRaises ValueError for what OpenCV cannot read.")
      .def("output_names", &OpenCvNetwork::outputNames, "Of the layers that no other uses.")
      .def("forward", &forward, "values"_a, "names"_a,
           "The values of the named layers for an input, float32 of four dimensions.\n\n"
           "Raises ValueError for what OpenCV cannot run.")
      .def("flop", &OpenCvNetwork::flop, "shape"_a, Unlocked(),
           "Floating point operations of a run as OpenCV counts them.\n\nRaises ValueError where it cannot.");
}

const Bindings kBindings("dnn_network", {}, bindNetwork);

}  // namespace dnn_network_bindings
