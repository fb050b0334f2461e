#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "leave_gil.hpp"

namespace robot_vision
{

namespace py = pybind11;

/// Of what may have to wait for a search in the background before it goes.
template <class T>
struct DeleteUnlocked
{
  void operator()(T* object) const
  {
    const LeaveGil unlocked;
    delete object;
  }
};

/// Whether a cv::Mat can view the array: packed pixels, rows that do not overlap, and aligned samples.
inline bool hasPackedRows(const py::array& array)
{
  const py::ssize_t channels = array.ndim() == 3 ? array.shape(2) : 1;
  const auto address = reinterpret_cast<std::uintptr_t>(array.data());
  return (array.ndim() == 2 || array.strides(2) == array.itemsize()) &&
         array.strides(1) == channels * array.itemsize() && array.strides(0) >= array.shape(1) * array.strides(1) &&
         array.strides(0) % array.itemsize() == 0 && address % static_cast<std::uintptr_t>(array.itemsize()) == 0;
}

/// An array of pixels and the view of it.
struct ImageArray
{
  explicit ImageArray(py::array pixels) : array(std::move(pixels))
  {
    const bool wide = py::isinstance<py::array_t<std::uint16_t>>(array);
    if (!wide && !py::isinstance<py::array_t<std::uint8_t>>(array))
      throw py::type_error("expected an array of uint8 or uint16, got " + std::string(py::str(array.dtype())));
    if (array.ndim() != 2 && array.ndim() != 3)
      throw py::value_error("expected an array of 2 or 3 dimensions, got " + std::to_string(array.ndim()));
    const auto channels = static_cast<int>(array.ndim() == 3 ? array.shape(2) : 1);
    if (channels < 1 || channels > 4)
      throw py::value_error("expected 1 to 4 channels, got " + std::to_string(channels));
    if (!hasPackedRows(array)) array = array.attr("copy")("C");
    view = cv::Mat(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)),
                   CV_MAKETYPE(wide ? CV_16U : CV_8U, channels), const_cast<void*>(array.data()),
                   static_cast<std::size_t>(array.strides(0)));
  }

  py::array array;
  cv::Mat view;
};

/// The array's own pixels, to draw on.
inline cv::Mat canvas(const py::array& bgr)
{
  const ImageArray image(bgr);
  if (bgr.size() == 0) throw py::value_error("cannot draw on an array without pixels");
  if (!bgr.writeable()) throw py::value_error("cannot draw on an array that is read-only");
  if (image.array.data() != bgr.data()) throw py::value_error("cannot draw on an array with gaps in its rows");
  return image.view;
}

/// NumPy's names of samples by cv::Mat depth, CV_8U to CV_64F.
constexpr const char* kSampleTypes[] = {"u1", "i1", "u2", "i2", "i4", "f4", "f8"};

/// Of a cv::Mat depth, CV_8U to CV_64F; that of bytes without a look at its name.
inline py::dtype sampleType(int depth)
{
  return depth == CV_8U ? py::dtype::of<std::uint8_t>() : py::dtype(kSampleTypes[depth]);
}

/// An array of the Mat's pixels, without a copy: (height, width), or (height, width, channels) if there are several.
/// `owner` is kept until the array and all views of it are gone. `Owner` keeps the pixels alive.
template <class Owner>
py::array toPython(const cv::Mat& mat, Owner owner)
{
  const py::capsule release(new Owner(std::move(owner)), [](void* p) { delete static_cast<Owner*>(p); });
  std::vector<py::ssize_t> shape = {mat.rows, mat.cols};
  if (mat.channels() > 1) shape.push_back(mat.channels());
  std::vector<py::ssize_t> strides = {static_cast<py::ssize_t>(mat.step[0]), static_cast<py::ssize_t>(mat.elemSize()),
                                      static_cast<py::ssize_t>(mat.elemSize1())};
  strides.resize(shape.size());
  return py::array(sampleType(mat.depth()), shape, strides, mat.data, release);
}

/// Pixel positions from Python: (n, 2) of any type of integer, or what NumPy makes such an array of.
inline std::vector<cv::Point> toPoints(const py::object& object)
{
  const py::array points = py::array::ensure(object);
  if (!points) throw py::type_error("expected an (n, 2) array of points");
  if (points.size() == 0) return {};
  if (points.ndim() != 2 || points.shape(1) != 2) throw py::value_error("expected an (n, 2) array of points");
  const char kind = points.dtype().kind();
  if (kind != 'i' && kind != 'u')
    throw py::type_error("expected points of whole pixels, got " + std::string(py::str(points.dtype())));
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> values(points);
  const std::int64_t far = 1 << 24;  // px: sums and differences of such numbers still fit an int
  std::vector<cv::Point> pixels;
  for (const auto* point = values.data(); point != values.data() + values.size(); point += 2)
  {
    if (std::min(point[0], point[1]) < -far || std::max(point[0], point[1]) > far)
      throw py::value_error("expected points in an image, got (" + std::to_string(point[0]) + ", " +
                            std::to_string(point[1]) + ")");
    pixels.emplace_back(static_cast<int>(point[0]), static_cast<int>(point[1]));
  }
  return pixels;
}

/// Numbers from Python, of any type that NumPy converts to double.
using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Numbers from Python, of any type that NumPy converts to float32.
using FloatArray = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// A view of a (height, width) array, which must outlive it; `expected` is what a message calls it.
inline cv::Mat floatView(const FloatArray& values, const std::string& expected = "(height, width) array of numbers")
{
  if (values.ndim() != 2) throw py::value_error("expected a " + expected);
  return {static_cast<int>(values.shape(0)), static_cast<int>(values.shape(1)), CV_32FC1,
          const_cast<float*>(values.data())};
}

/// `expected` is what a message calls it.
inline cv::Affine3d toPose(const Matrix& matrix, const std::string& expected = "4x4 pose")
{
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw py::value_error("expected a " + expected);
  return cv::Affine3d(cv::Matx44d(matrix.data()));
}

/// The corners of a tag from a (4, 2) array; `whose` is what a message calls it.
inline std::array<cv::Point2d, 4> toCorners(const Matrix& matrix, const std::string& whose = "a tag")
{
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 2)
    throw py::value_error("expected a (4, 2) array of the corners of " + whose);
  std::array<cv::Point2d, 4> corners;
  for (py::ssize_t i = 0; i < 4; ++i)
    corners[static_cast<std::size_t>(i)] = {matrix.at(i, 0), matrix.at(i, 1)};
  return corners;
}

/// x, y, width, height.
using Box = std::tuple<int, int, int, int>;

inline cv::Rect toRect(const Box& box)
{
  return {std::get<0>(box), std::get<1>(box), std::get<2>(box), std::get<3>(box)};
}

/// An array that owns the Mat's pixels.
inline py::array toPython(const cv::Mat& mat)
{
  return toPython(mat, mat);
}

/// (n, 2) array of a copy of the points.
template <class T>
py::array_t<T> toPython(const std::vector<cv::Point_<T>>& points)
{
  return py::array_t<T>({static_cast<py::ssize_t>(points.size()), py::ssize_t{2}},
                        points.empty() ? nullptr : &points[0].x);
}

/// (4, 2) array.
inline py::array_t<double> toPython(const std::array<cv::Point2d, 4>& corners)
{
  return py::array_t<double>({4, 2}, &corners[0].x);
}

template <int rows, int columns>
py::array_t<double> toPython(const cv::Matx<double, rows, columns>& matrix)
{
  return py::array_t<double>({rows, columns}, matrix.val);
}

/// 4x4.
inline py::array_t<double> toPython(const cv::Affine3d& pose)
{
  return toPython(pose.matrix);
}

/// (x, y).
inline std::pair<double, double> toPython(const cv::Point2d& point)
{
  return {point.x, point.y};
}

inline Box toPython(const cv::Rect& box)
{
  return {box.x, box.y, box.width, box.height};
}

/// Reads a member of an object as toPython() gives it.
template <class T, class Member>
auto attribute(Member T::*member)
{
  return [member](const T& object) { return toPython(object.*member); };
}

/// An array of the image that `make` writes into a cv::Mat, without the GIL.
template <class Make>
py::array imageFrom(const Make& make)
{
  cv::Mat image;
  {
    const LeaveGil unlocked;
    make(image);
  }
  return toPython(image);
}

/// What a filter of the core makes of an array. `Filter` is made of Params and has apply().
template <class Filter, class Params>
py::array applyFilter(const py::array& image, const std::string& encoding, const Params& params)
{
  const ImageArray input(image);
  return imageFrom([&](cv::Mat& output) { Filter(params).apply(input.view, encoding, output); });
}

/// A method for an image of some encoding, which is called with an array and without the GIL.
template <class T, class Result>
auto withArray(Result (T::*method)(const cv::Mat& image, const std::string& encoding))
{
  return [method](T& object, const py::array& image, const std::string& encoding)
  {
    const ImageArray input(image);
    const LeaveGil unlocked;
    return (object.*method)(input.view, encoding);
  };
}

/// The same for a frame of a time, s.
template <class T, class Result>
auto withArray(Result (T::*method)(double time, const cv::Mat& image, const std::string& encoding))
{
  return [method](T& object, double time, const py::array& image, const std::string& encoding)
  {
    const ImageArray input(image);
    const LeaveGil unlocked;
    return (object.*method)(time, input.view, encoding);
  };
}

}  // namespace robot_vision
