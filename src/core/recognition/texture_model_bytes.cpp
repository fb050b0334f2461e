#include "byte_stream.hpp"
#include "model_head.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/recognition/texture_model.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kPointBytes = 7 * sizeof(float) + sizeof(std::int32_t);

void add(const std::string& text, ByteWriter& to)
{
  to.add(static_cast<std::uint8_t>(text.size()));
  to.addText(text);
}

void add(int number, ByteWriter& to)
{
  to.add(static_cast<std::int32_t>(number));
}

void get(std::string& text, ByteReader& from)
{
  text = printable(from.text(from.next<std::uint8_t>()));  // for the message, if it is none that is known
}

void get(int& number, ByteReader& from)
{
  number = from.next<std::int32_t>();
}

template <class Point, class Visit>
void visitFloats(Point& point, const Visit& visit)
{
  visitThree(point.position, visit);
  visitThree(point.direction, visit);
  visit(point.size);
}

/// The numbers of a descriptor, one after the other.
template <class Number>
void addRow(const cv::Mat& descriptors, int row, ByteWriter& to)
{
  for (int column = 0; column < descriptors.cols; ++column)
    to.add(descriptors.at<Number>(row, column));
}

template <class Number>
void getRow(cv::Mat& descriptors, int row, ByteReader& from)
{
  for (int column = 0; column < descriptors.cols; ++column)
    from.get(descriptors.at<Number>(row, column));
}

}  // namespace

std::vector<std::uint8_t> toBytes(const TextureModel& model)
{
  validate(model);
  ByteWriter to;
  writeModelHead(TextureModel::kMethod, to);
  TextureParams::fields([&](const char* /*name*/, auto member, const auto& /*limits*/, const char* /*unit*/,
                            const char* /*meaning*/) { add(model.params.*member, to); });
  visitExtent(model.extent, [&](double number) { to.add(number); });
  add(model.views, to);
  to.add(static_cast<std::uint16_t>(model.descriptors.cols));
  to.add(static_cast<std::uint32_t>(model.points.size()));
  for (std::size_t i = 0; i < model.points.size(); ++i)
  {
    visitFloats(model.points[i], [&](float number) { to.add(number); });
    add(model.points[i].views, to);
    const auto row = static_cast<int>(i);
    model.descriptors.depth() == CV_32F ? addRow<float>(model.descriptors, row, to)
                                        : addRow<uchar>(model.descriptors, row, to);
  }
  return to.take();
}

TextureModel textureModelFromBytes(const std::uint8_t* bytes, std::size_t size)
{
  ByteReader from(bytes, size, "a trained model");
  checkModelHead(TextureModel::kMethod, from);
  TextureModel model;
  TextureParams::fields([&](const char* /*name*/, auto member, const auto& /*limits*/, const char* /*unit*/,
                            const char* /*meaning*/) { get(model.params.*member, from); });
  visitExtent(model.extent, [&](double& number) { from.get(number); });
  get(model.views, from);
  const bool is_float = model.params.detector == "sift";
  const auto columns = from.next<std::uint16_t>();
  const std::size_t row_bytes = columns * (is_float ? sizeof(float) : 1);
  const std::size_t count = from.count<std::uint32_t>("keypoints", kPointBytes + row_bytes);
  require(count <= kMaxTexturePoints, "the number of keypoints of a model", static_cast<double>(count),
          "at most " + std::to_string(kMaxTexturePoints));
  model.points.resize(count);
  if (count > 0) model.descriptors.create(static_cast<int>(count), columns, is_float ? CV_32FC1 : CV_8UC1);
  for (std::size_t i = 0; i < count; ++i)
  {
    visitFloats(model.points[i], [&](float& number) { from.get(number); });
    get(model.points[i].views, from);
    const auto row = static_cast<int>(i);
    is_float ? getRow<float>(model.descriptors, row, from) : getRow<uchar>(model.descriptors, row, from);
  }
  from.end();
  validate(model);
  return model;
}

}  // namespace robot_vision
