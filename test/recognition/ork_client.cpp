// A client of object_recognition_core, compiled with its own messages: prints what is recognized, and what the service
// get_object_info says of each object. For test_object_recognizer_node.py.

#include <object_recognition_msgs/GetObjectInformation.h>
#include <object_recognition_msgs/RecognizedObjectArray.h>
#include <object_recognition_msgs/TableArray.h>
#include <ros/ros.h>

#include <iostream>

namespace
{

void printInformation(const object_recognition_msgs::ObjectType& type)
{
  object_recognition_msgs::GetObjectInformation call;
  call.request.type = type;
  if (!ros::service::call("get_object_info", call)) throw std::runtime_error("get_object_info has failed");
  const auto& information = call.response.information;
  std::cout << "information " << information.name << ' ' << information.ground_truth_mesh.vertices.size() << ' '
            << information.ground_truth_mesh.triangles.size() << std::endl;
}

void printObjects(const object_recognition_msgs::RecognizedObjectArrayConstPtr& array)
{
  for (const auto& object : array->objects)
  {
    const auto& position = object.pose.pose.pose.position;
    std::cout << "object " << object.type.key << ' ' << object.confidence << ' ' << position.x << ' ' << position.y
              << ' ' << position.z << std::endl;
    printInformation(object.type);
  }
}

void printTables(const object_recognition_msgs::TableArrayConstPtr& array)
{
  for (const auto& table : array->tables)
    std::cout << "table " << table.convex_hull.size() << std::endl;
}

}  // namespace

int main(int argc, char** argv)
{
  ros::init(argc, argv, "ork_client");
  ros::NodeHandle node;
  const ros::Subscriber objects = node.subscribe("recognized_object_array", 1, printObjects);
  const ros::Subscriber tables = node.subscribe("table_array", 1, printTables);
  ros::spin();
}
