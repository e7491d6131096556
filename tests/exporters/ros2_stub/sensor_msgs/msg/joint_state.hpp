// Stands for the message of ROS 2 in tests.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "std_msgs/msg/header.hpp"

namespace sensor_msgs::msg {
struct JointState {
  using ConstSharedPtr = std::shared_ptr<const JointState>;
  std_msgs::msg::Header header;
  std::vector<std::string> name;
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> effort;
};
}  // namespace sensor_msgs::msg
