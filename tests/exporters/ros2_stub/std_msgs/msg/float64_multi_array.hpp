// Stands for the message of ROS 2 in tests; shown with all bits.
#pragma once
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace std_msgs::msg {
struct Float64MultiArray {
  using ConstSharedPtr = std::shared_ptr<const Float64MultiArray>;
  std::vector<double> data;
};
inline std::string shown(const Float64MultiArray &message) {
  std::string text;
  for (const double number : message.data) {
    char digits[64];
    (void)std::snprintf(digits, sizeof digits, "%a", number);
    text += digits;
  }
  return text;
}
}  // namespace std_msgs::msg
