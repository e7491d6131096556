// Stands for the message of ROS 2 in tests.
#pragma once
#include <memory>
#include <string>

namespace std_msgs::msg {
struct String {
  using ConstSharedPtr = std::shared_ptr<const String>;
  std::string data;
};
inline std::string shown(const String &message) { return message.data; }
}  // namespace std_msgs::msg
