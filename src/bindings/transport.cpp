#include <dynamic_reconfigure/config_tools.h>
#include <pybind11/stl.h>
#include <ros/serialization.h>

#include "any_image.hpp"
#include "arrays.hpp"
#include "leave_gil.hpp"
#include "ros/bonds/bonds.hpp"
#include "ros/images/embedded_roscpp_node.hpp"
#include "ros/params/package_file.hpp"
#include "ros/params/save_params.hpp"
#include "ros/shared_memory/signals_blocked.hpp"

namespace
{

using namespace robot_vision;
using namespace py::literals;
using CallsMaster = py::call_guard<LeaveGil, SignalsBlocked>;

py::bytes serialized(const sensor_msgs::CameraInfo& info)
{
  std::string bytes(ros::serialization::serializationLength(info), '\0');
  ros::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(&bytes[0]),
                                     static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, info);
  return bytes;
}

/// Text of a message, which may not be UTF-8.
py::str toStr(const std::string& text)
{
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

/// (inbox, pixels, encoding, seq, secs, nsecs, frame_id, camera_info as serialized or None), or None.
py::object next(NodeQueue& queue, double timeout_s)
{
  auto delivery = withoutGil([&] { return queue.next(timeout_s); });
  if (!delivery) return py::none();
  ReceivedImage& received = delivery->image;
  const std_msgs::Header& header = received.header;
  const py::array pixels = toPython(received.pixels.image, received.pixels);
  py::detail::array_proxy(pixels.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  py::object info = py::none();
  if (received.camera_info) info = serialized(*received.camera_info);
  return py::make_tuple(std::move(delivery->inbox), pixels, received.encoding, header.seq, header.stamp.sec,
                        header.stamp.nsec, toStr(header.frame_id), info);
}

/// A time as it came: ros::Time's constructor throws for times that nothing can be done about.
ros::Time stampOf(std::uint32_t secs, std::uint32_t nsecs)
{
  ros::Time stamp;
  stamp.sec = secs;
  stamp.nsec = nsecs;
  return stamp;
}

void publish(PooledImagePublisher& outbox, const py::array& pixels, const std::string& encoding, std::uint32_t secs,
             std::uint32_t nsecs, const std::string& frame_id)
{
  const py::array packed = anyImage(pixels);
  const cv::Mat view = viewOf(packed);
  std_msgs::Header header;
  header.stamp = stampOf(secs, nsecs);
  header.frame_id = frame_id;
  const LeaveGil unlocked;
  outbox.publish(view, encoding, header);
}

/// `values`: bool, int, float and str by name.
std::string edit(const std::string& path, const std::string& text, const py::dict& values)
{
  using dynamic_reconfigure::ConfigTools;
  dynamic_reconfigure::Config config;
  for (const auto& [key, value] : values)
  {
    const auto name = key.cast<std::string>();
    if (py::isinstance<py::bool_>(value))
      ConfigTools::appendParameter(config, name, value.cast<bool>());
    else if (py::isinstance<py::int_>(value))
      ConfigTools::appendParameter(config, name, value.cast<int>());
    else if (py::isinstance<py::float_>(value))
      ConfigTools::appendParameter(config, name, value.cast<double>());
    else
      ConfigTools::appendParameter(config, name, value.cast<std::string>());
  }
  return editParams(path, text, config);
}

std::shared_ptr<LatestImageSubscriber> makeInbox(NodeQueue& queue, const std::string& topic,
                                                 const std::string& transport, const std::string& parameters,
                                                 const std::string& encoding, const std::string& camera_info_topic,
                                                 std::shared_ptr<FrameStatistics> statistics)
{
  if (!statistics) statistics = std::make_shared<FrameStatistics>();
  return queue.makeInbox({topic, transport, parameters, encoding, camera_info_topic}, std::move(statistics));
}

void loadNodelet(EmbeddedRoscppNode& runtime, const std::string& name, const std::string& type,
                 const nodelet::M_string& remappings, const nodelet::V_string& arguments)
{
  runtime.nodelets()->load(name, type, remappings, arguments);
  runtime.noteServices();  // which other packages' nodelets may have without a topic
}

std::unique_ptr<Bonds> makeBonds(const std::string& topic, double connect_timeout, double heartbeat_timeout,
                                 double disconnect_timeout, double period)
{
  const BondTimes times{connect_timeout, heartbeat_timeout, disconnect_timeout, period};
  const LeaveGil unlocked;
  const SignalsBlocked blocked;
  return std::make_unique<Bonds>(topic, times);
}

}  // namespace

PYBIND11_MODULE(_transport, m)
{
  m.doc() = "What nodes in Python have of roscpp: images for robot_vision.transport, which is documented, and bonds.";
  LeaveGil::endWithProcess();
  py::class_<FrameStatistics, std::shared_ptr<FrameStatistics>>(m, "Diagnostics")
      .def("set_running", &FrameStatistics::setRunning, "topic"_a)
      .def("set_lacking", &FrameStatistics::setLacking, "lack"_a, "topic"_a)
      .def("set_unsubscribed", &FrameStatistics::setUnsubscribed, "reason"_a);
  py::class_<LatestImageSubscriber, std::shared_ptr<LatestImageSubscriber>>(m, "Inbox")
      .def("open", &LatestImageSubscriber::open, CallsMaster())
      .def("close", &LatestImageSubscriber::close, CallsMaster())
      .def("publishers", &LatestImageSubscriber::publishers, Unlocked())
      .def("finished", &LatestImageSubscriber::finished)
      .def(
          "finished_later",
          [](LatestImageSubscriber& inbox, double processing_s, std::uint32_t secs, std::uint32_t nsecs)
          { inbox.finishedLater(processing_s, stampOf(secs, nsecs)); },
          "processing_s"_a, "secs"_a, "nsecs"_a)
      .def("failed", &LatestImageSubscriber::failed, "why"_a, Unlocked())
      .def_property_readonly("received", [](const LatestImageSubscriber& inbox) { return inbox.totals().received; })
      .def_property_readonly("dropped", [](const LatestImageSubscriber& inbox) { return inbox.totals().dropped; })
      .def_property_readonly("refused", [](const LatestImageSubscriber& inbox) { return inbox.totals().refused; });
  py::class_<PooledImagePublisher, std::shared_ptr<PooledImagePublisher>>(m, "Outbox")
      .def("close", &PooledImagePublisher::close, CallsMaster())
      .def("subscribers", &PooledImagePublisher::subscribers, Unlocked())
      .def("publish", publish, "pixels"_a, "encoding"_a, "secs"_a, "nsecs"_a, "frame_id"_a);
  py::class_<NodeQueue, std::shared_ptr<NodeQueue>>(m, "Queue")
      .def("inbox", makeInbox, "topic"_a, "transport"_a, "parameters"_a, "encoding"_a, "camera_info_topic"_a,
           "diagnostics"_a, CallsMaster(), py::keep_alive<0, 1>())
      .def("outbox", &NodeQueue::makeOutbox, "topic"_a, CallsMaster(), py::keep_alive<0, 1>())
      .def("diagnostics", &NodeQueue::makeStatistics, CallsMaster())
      .def("next", next, "timeout"_a)
      .def("interrupt", &NodeQueue::interrupt, Unlocked())
      .def("running", &NodeQueue::running)
      .def("note_connections", &NodeQueue::noteConnections, Unlocked())
      .def("connections_changed", &NodeQueue::connectionsChanged)
      .def("close", &NodeQueue::close, CallsMaster());
  py::class_<EmbeddedRoscppNode>(m, "Runtime")
      .def(py::init<const std::string&, const ros::M_string&, const std::string&, const std::string&>(), "name"_a,
           "options"_a, "node"_a, "node_uri"_a, CallsMaster())
      .def("queue", &EmbeddedRoscppNode::makeQueue, "node"_a, "diagnostics_topic"_a = "/diagnostics", CallsMaster(),
           py::keep_alive<0, 1>())
      .def("load_nodelet", loadNodelet, "name"_a, "type"_a, "remappings"_a, "arguments"_a, CallsMaster())
      .def(
          "unload_nodelet",
          [](EmbeddedRoscppNode& runtime, const std::string& name) { return runtime.nodelets()->unload(name); },
          "name"_a, CallsMaster())
      .def(
          "nodelets", [](EmbeddedRoscppNode& runtime) { return runtime.nodelets()->names(); }, CallsMaster())
      .def(
          "nodelet_types", [](EmbeddedRoscppNode& runtime) { return runtime.nodelets()->types(); }, CallsMaster())
      .def("running", &EmbeddedRoscppNode::running)
      .def("stop", &EmbeddedRoscppNode::stop, CallsMaster());
  const BondTimes usual;
  py::class_<Bonds>(m, "Bonds")
      .def(py::init(&makeBonds), "topic"_a, "connect_timeout"_a = usual.connect,
           "heartbeat_timeout"_a = usual.heartbeat, "disconnect_timeout"_a = usual.disconnect,
           "period"_a = usual.period)
      .def("form", &Bonds::form, "id"_a, Unlocked())
      .def("end", &Bonds::end, "id"_a, Unlocked())
      .def("next_broken", &Bonds::nextBroken, Unlocked())
      .def("close", &Bonds::close, CallsMaster());
  m.def("edit_params", edit, "path"_a, "text"_a, "values"_a,
        "The YAML text of the file `path` with the values in it; see save_params.hpp. Raises RuntimeError naming the "
        "path.");
  m.def(
      "require_own_launch", &requireOwnLaunch, "path"_a, "is_started_by_roslaunch"_a,
      "Raises RuntimeError for a file of this package if roslaunch did not start this process; see package_file.hpp.");
}
