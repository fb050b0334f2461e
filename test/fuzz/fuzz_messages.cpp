// Takes inputs for one target as worker.py does: what nodes in C++, and the C++ half of those in Python, do with
// messages, without a ROS master.

#include <sensor_msgs/CompressedImage.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>

#include "robot_vision/codecs/compressed_depth.hpp"
#include "robot_vision/codecs/compressed_image.hpp"
#include "robot_vision/codecs/image_file.hpp"
#include "robot_vision/codecs/theora.hpp"
#include "robot_vision/edges/edges.hpp"
#include "ros/camera/calibration_file.hpp"
#include "ros/images/bounded_reading.hpp"
#include "ros/images/image_message.hpp"
#include "ros/transports/plugins/theora_packet.hpp"

using namespace robot_vision;

namespace
{

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kLimit = std::size_t{1500} << 20;  // bytes that one input may need
constexpr std::size_t kLongestError = 1000;

template <class Message>
boost::shared_ptr<Message> read(Bytes& input, boost::shared_ptr<Message> message = boost::make_shared<Message>())
{
  readBounded(input.data(), static_cast<std::uint32_t>(input.size()), *message);
  return message;
}

/// A raw image's way through a node that finds edges, and through one in Python that asks for bgr8.
struct Raw
{
  void operator()(Bytes& input) const
  {
    const sensor_msgs::ImagePtr message = read(input, pool.take());
    try
    {
      convertPixels(*message, "bgr8");
      const cv::Mat pixels = viewPixels(*message);
      cv::Mat edges;
      EdgeDetector(EdgeParams()).apply(pixels, message->encoding, edges);
    }
    catch (const std::invalid_argument& e)
    {
      throw std::invalid_argument(describeRefusal(*message, "/image", e.what()));
    }
  }

  ImagePool pool;
};

/// An image or depths, compressed.
struct Compressed
{
  void operator()(Bytes& input)
  {
    const auto message = read<sensor_msgs::CompressedImage>(input);
    const std::uint8_t* data = message->data.data();
    const std::size_t size = message->data.size();
    images.make(
        [&](cv::Mat& pixels)
        {
          if (is_depth) return decompressDepth(message->format, data, size, pixels);
          return decompress(message->format, data, size, ColorMode::kUnchanged, 1, pixels);
        });
  }

  bool is_depth;
  ImageMaker images = {};
};

/// A stream of packets, each behind its length; it begins anew with each input, as with each sender.
struct Theora
{
  void operator()(Bytes& input)
  {
    std::string problem;
    for (std::size_t at = 0; at + 4 <= input.size();)
    {
      std::size_t count = 0;
      for (int i = 3; i >= 0; --i)
        count = count << 8 | input[at + static_cast<std::size_t>(i)];
      at += 4;
      count = std::min(count, input.size() - at);
      Bytes part(input.begin() + static_cast<std::ptrdiff_t>(at),
                 input.begin() + static_cast<std::ptrdiff_t>(at + count));
      at += count;
      const auto message = read<TheoraPacketMessage>(part);
      try
      {
        decoder.decode(
            {message->data, message->b_o_s != 0, message->e_o_s != 0, message->granulepos, message->packetno}, image);
      }
      catch (const std::invalid_argument& e)
      {
        problem = e.what();
      }
    }
    if (!problem.empty()) throw std::invalid_argument(problem);
  }

  TheoraDecoder decoder;
  cv::Mat image;
};

/// What the transports of nodes in Python hand on; set_camera_info's request is the same.
struct ReceivedInfos
{
  void operator()(Bytes& input) const
  {
    if (*read<sensor_msgs::CameraInfo>(input) == sensor_msgs::CameraInfo()) throw std::invalid_argument("cut short");
  }
};

struct Files
{
  void operator()(Bytes& input) const
  {
    if (decodeImageFile(input.data(), input.size(), 1).empty()) throw std::invalid_argument("no image");
  }
};

/// The text of the file that a camera loads.
struct Calibrations
{
  void operator()(Bytes& input) const
  try
  {
    std::string camera_name;
    parseCalibration(std::string(input.begin(), input.end()), CalibrationFormat::kYaml, camera_name);
  }
  catch (const std::runtime_error& e)
  {
    throw std::invalid_argument(e.what());
  }
};

/// Three headers and two frames, which nothing in Python can make.
Bytes theoraSeed()
{
  Bytes stream;
  TheoraEncoder encoder;
  for (int i = 0; i < 2; ++i)
    for (const TheoraPacket& packet : encoder.encode(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(60 * i))))
    {
      TheoraPacketMessage message;
      message.data = packet.data;
      message.b_o_s = packet.begins_stream ? 1 : 0;
      message.granulepos = packet.granule_position;
      message.packetno = packet.number;
      const std::uint32_t size = ros::serialization::serializationLength(message);
      const std::size_t at = stream.size();
      stream.resize(at + sizeof(size) + size);
      ros::serialization::OStream out(stream.data() + at, size + sizeof(size));
      out.next(size);
      out.next(message);
    }
  return stream;
}

using Target = std::function<void(Bytes&)>;

Target targetOf(const std::string& name)
{
  if (name == "raw") return Raw();
  if (name == "received_infos") return ReceivedInfos();
  if (name == "compressed") return Compressed{false};
  if (name == "compressed_depth") return Compressed{true};
  if (name == "files") return Files();
  if (name == "calibrations") return Calibrations();
  if (name == "theora") return [theora = std::make_shared<Theora>()](Bytes& input) { (*theora)(input); };
  throw std::runtime_error("there is no target '" + name + "'");
}

bool isLine(const std::string& text)
{
  const auto plain = [](unsigned char c) { return c >= ' ' && c <= '~'; };
  return !text.empty() && text.size() <= kLongestError && std::all_of(text.begin(), text.end(), plain);
}

std::string answer(const Target& target, Bytes& input)
try
{
  target(input);
  return "taken";
}
catch (const std::invalid_argument& e)
{
  const std::string text = e.what();
  return isLine(text) ? "refused: " + text : "failed: no line of text, " + std::to_string(text.size()) + " letters";
}
catch (const std::exception& e)
{
  return std::string("failed: ") + e.what();
}

/// Of memory that the process has, and may have more of.
void limitMemory()
{
  std::ifstream file("/proc/self/statm");
  std::size_t pages = 0;
  file >> pages;
  const rlim_t most = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + kLimit;
  const rlimit limit{most, most};
  setrlimit(RLIMIT_AS, &limit);
}

bool readExactly(void* to, std::size_t count)
{
  return std::fread(to, 1, count, stdin) == count;
}

}  // namespace

int main(int argc, char** argv)
{
  const std::string name = argc > 1 ? argv[1] : "";
  if (argc > 2)  // "seed"
  {
    const Bytes seed = theoraSeed();
    std::fwrite(seed.data(), 1, seed.size(), stdout);
    return 0;
  }
  Target target = targetOf(name);
  limitMemory();
  std::cout << "ready" << std::endl;
  for (std::uint32_t size = 0; readExactly(&size, sizeof(size));)
  {
    Bytes input(size);
    if (size > 0 && !readExactly(input.data(), size)) break;
    std::cout << answer(target, input) << std::endl;
  }
  return 0;
}
