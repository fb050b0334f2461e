#include "frame_view.hpp"

#include "robot_vision/codecs/compressed_image.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{

sensor_msgs::ImageConstPtr FrameView::image(const std::string& encoding)
try
{
  sensor_msgs::ImageConstPtr& made = images_[encoding];
  if (made) return made;
  const sensor_msgs::ImagePtr image = makers_.of(encoding, encoding == raw_encoding_)
                                          .make(
                                              [&](cv::Mat& pixels)
                                              {
                                                toEncoding(frame_.pixels, frame_.encoding, encoding, pixels);
                                                return encoding;
                                              });
  image->header = header_;
  size_ = {static_cast<int>(image->width), static_cast<int>(image->height)};
  return made = image;
}
catch (const std::exception&)
{
  damage_ = std::current_exception();
  throw;
}

sensor_msgs::CompressedImage FrameView::jpeg()
{
  sensor_msgs::CompressedImage message;
  const JpegInfo info = copyJpeg(frame_.pixels.data, frame_.pixels.total(), message.data);
  message.header = header_;
  message.format = jpegFormat(info.color);
  size_ = info.size;
  return message;
}

cv::Size FrameView::size()
{
  if (size_.empty() && damage_) std::rethrow_exception(damage_);
  if (size_.empty()) size_ = imageSize(frame_.pixels, frame_.encoding);
  return size_;
}

}  // namespace robot_vision
