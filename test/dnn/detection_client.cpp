// A client of darknet_ros and of detectors that publish vision_msgs, compiled with their own messages: prints what it
// gets. For test_object_detector_node.py.

#include <darknet_ros_msgs/BoundingBoxes.h>
#include <darknet_ros_msgs/ObjectCount.h>
#include <ros/ros.h>
#include <vision_msgs/Detection2DArray.h>

#include <iostream>

namespace
{

void printBoxes(const darknet_ros_msgs::BoundingBoxesConstPtr& boxes)
{
  for (const auto& box : boxes->bounding_boxes)
    std::cout << "box " << boxes->image_header.stamp << ' ' << box.Class << ' ' << box.id << ' ' << box.xmin << ' '
              << box.ymin << ' ' << box.xmax << ' ' << box.ymax << std::endl;
}

void printCount(const darknet_ros_msgs::ObjectCountConstPtr& objects)
{
  std::cout << "count " << objects->header.stamp << ' ' << static_cast<int>(objects->count) << std::endl;
}

void printDetections(const vision_msgs::Detection2DArrayConstPtr& detections)
{
  for (const auto& detection : detections->detections)
    std::cout << "detection " << detections->header.stamp << ' ' << detection.results.at(0).id << ' '
              << detection.bbox.center.x << ' ' << detection.bbox.center.y << ' ' << detection.bbox.size_x << ' '
              << detection.bbox.size_y << std::endl;
}

}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "detection_client");
  ros::NodeHandle node;
  const ros::Subscriber boxes = node.subscribe("bounding_boxes", 1, printBoxes);
  const ros::Subscriber counts = node.subscribe("found_object", 1, printCount);
  const ros::Subscriber detections = node.subscribe("detections", 1, printDetections);
  ros::spin();
}
