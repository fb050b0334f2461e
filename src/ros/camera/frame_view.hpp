#pragma once

#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <cstddef>
#include <exception>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "robot_vision/image/encoding.hpp"
#include "ros/images/image_message.hpp"

namespace robot_vision
{

/// The makers of a camera's image messages by encoding, as a maker expects each image to be like the last one.
class ImageMakers
{
public:
  /// Adds a topic on which images of an encoding are going to be published, that of image_raw by default, see
  /// ImagePool. Images of others stay out of its memory, which is for images of one size.
  void addTopic(std::shared_ptr<SharedTopic> topic, const std::string& encoding = "")
  {
    topics_.push_back(std::move(topic));
    encodings_.push_back(encoding);
  }

  const std::vector<std::shared_ptr<SharedTopic>>& topics() const { return topics_; }

  /// `is_raw`: whether it is at present the encoding of image_raw.
  ImageMaker& of(const std::string& encoding, bool is_raw)
  {
    const auto [maker, is_new] = makers_.try_emplace({encoding, is_raw});
    if (is_new)
      for (std::size_t i = 0; i < topics_.size(); ++i)
        if (encodings_[i].empty() ? is_raw : encodings_[i] == encoding) maker->second.addTopic(topics_[i]);
    return maker->second;
  }

private:
  std::vector<std::shared_ptr<SharedTopic>> topics_;
  std::vector<std::string> encodings_;  // of these; "" for that of image_raw
  std::map<std::pair<std::string, bool>, ImageMaker> makers_;
};

/// One image of a frame and the messages that are made of it. It is converted when that is first asked for, and only
/// once.
class FrameView
{
public:
  /// `raw_encoding` is the encoding of image_raw. The other arguments must outlive the view.
  FrameView(const EncodedImage& frame, const std_msgs::Header& header, const std::string& raw_encoding,
            ImageMakers& makers)
    : frame_(frame), header_(header), raw_encoding_(raw_encoding), makers_(makers)
  {
  }

  const std_msgs::Header& header() const { return header_; }
  const std::string& givenEncoding() const { return frame_.encoding; }
  const std::string& rawEncoding() const { return raw_encoding_; }
  bool isJpeg() const { return frame_.encoding == "jpeg"; }

  /// The image in this encoding, or in that of image_raw. Both throw std::invalid_argument if the frame is damaged.
  sensor_msgs::ImageConstPtr image(const std::string& encoding);
  sensor_msgs::ImageConstPtr raw() { return image(raw_encoding_); }

  /// The JPEG that the camera has sent, without decoding it. Throws std::invalid_argument if it is truncated.
  sensor_msgs::CompressedImage jpeg();

  /// The size of the image in px, which no JPEG is decoded for. Throws what image() has thrown, unless the size is
  /// known nevertheless, and std::invalid_argument if the frame is too damaged to tell.
  cv::Size size();

  /// The same, but empty if nothing has found it out so far.
  cv::Size knownSize() const { return size_; }

private:
  const EncodedImage& frame_;
  const std_msgs::Header& header_;
  std::string raw_encoding_;
  ImageMakers& makers_;
  std::map<std::string, sensor_msgs::ImageConstPtr> images_;  // by encoding
  std::exception_ptr damage_;                                 // what image() has thrown, else null
  cv::Size size_;
};

}  // namespace robot_vision
