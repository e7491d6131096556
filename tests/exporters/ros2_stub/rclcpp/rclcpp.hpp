// Stands for rclcpp in tests: one node, a clock that the script sets, and messages from the script.
//
// Lines of standard input, in order:
//   parameter NAME TEXT
//   joint TOPIC STAMP FIELD NAME VALUE [FIELD NAME VALUE ...]   a JointState, STAMP in ns
//   string TOPIC TEXT
//   at TIME                                                     the clock, in ns; timers that are due
// Every message that the node publishes is a line of standard output: TOPIC and its text.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "sensor_msgs/msg/joint_state.hpp"
#include "std_msgs/msg/string.hpp"

namespace rclcpp {

class QoS {
 public:
  explicit QoS(std::size_t depth) { (void)depth; }
  QoS &keep_last(std::size_t depth) {
    (void)depth;
    return *this;
  }
  QoS &transient_local() { return *this; }
};

class SensorDataQoS : public QoS {
 public:
  SensorDataQoS() : QoS(5) {}
};

class Time {
 public:
  explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  explicit Time(const builtin_interfaces::msg::Time &stamp)
      : nanoseconds_(std::int64_t(stamp.sec) * 1000000000 + stamp.nanosec) {}
  std::int64_t nanoseconds() const { return nanoseconds_; }

 private:
  std::int64_t nanoseconds_;
};

class Duration {
 public:
  explicit Duration(std::chrono::nanoseconds length) : length_(length.count()) {}
  std::int64_t nanoseconds() const { return length_; }

 private:
  std::int64_t length_;
};

class Logger {};
inline const char *name_of(const Logger &logger) {
  (void)logger;
  return "node";
}

class Clock {
 public:
  using SharedPtr = std::shared_ptr<Clock>;
  std::int64_t time = 0;
};

class TimerBase {
 public:
  using SharedPtr = std::shared_ptr<TimerBase>;
  std::int64_t period = 0;
  std::int64_t due = 0;
  std::function<void()> call;
};

template <typename Message>
class Subscription {
 public:
  using SharedPtr = std::shared_ptr<Subscription>;
  std::function<void(typename Message::ConstSharedPtr)> call;
};

template <typename Message>
class Publisher {
 public:
  using SharedPtr = std::shared_ptr<Publisher>;
  std::string topic;
  void publish(const Message &message) {
    std::cout << topic << " " << shown(message) << "\n";
  }
};

inline std::map<std::string, std::string> &parameters() {
  static std::map<std::string, std::string> given;
  return given;
}

class Node {
 public:
  explicit Node(std::string name) : name_(std::move(name)), clock_(std::make_shared<Clock>()) {}

  template <typename T>
  T declare_parameter(const std::string &name, const T &usual) {
    const auto found = parameters().find(name);
    if (found == parameters().end()) {
      return usual;
    }
    std::istringstream text(found->second);
    T value;
    text >> value;
    return value;
  }

  template <typename Message, typename Call>
  typename Subscription<Message>::SharedPtr create_subscription(
      const std::string &topic, const QoS &quality, Call call) {
    (void)quality;
    auto made = std::make_shared<Subscription<Message>>();
    made->call = call;
    keep(topic, made);
    return made;
  }

  template <typename Message>
  typename Publisher<Message>::SharedPtr create_publisher(
      const std::string &topic, const QoS &quality) {
    (void)quality;
    auto made = std::make_shared<Publisher<Message>>();
    made->topic = topic;
    return made;
  }

  Time now() const { return Time(clock_->time); }
  Clock::SharedPtr get_clock() { return clock_; }
  Logger get_logger() const { return Logger(); }

  std::map<std::string, Subscription<sensor_msgs::msg::JointState>::SharedPtr> joints;
  std::map<std::string, Subscription<std_msgs::msg::String>::SharedPtr> strings;
  TimerBase::SharedPtr timer;

 private:
  void keep(const std::string &topic, Subscription<sensor_msgs::msg::JointState>::SharedPtr made) {
    joints[topic] = made;
  }
  void keep(const std::string &topic, Subscription<std_msgs::msg::String>::SharedPtr made) {
    strings[topic] = made;
  }

  std::string name_;
  Clock::SharedPtr clock_;
};

template <typename Call>
TimerBase::SharedPtr create_timer(
    Node *node, Clock::SharedPtr clock, const Duration &period, Call call) {
  auto made = std::make_shared<TimerBase>();
  made->period = period.nanoseconds();
  made->due = clock->time + made->period;
  made->call = call;
  node->timer = made;
  return made;
}

inline void init(int argc, char *argv[]) {
  (void)argc;
  (void)argv;
  std::string word, name, text;
  while (std::cin.peek() == 'p' && std::cin >> word >> name && std::getline(std::cin >> std::ws, text)) {
    parameters()[name] = text;
  }
}

inline void shutdown() {}

inline void deliver_joint(Node &node, std::istringstream &line) {
  std::string topic, field, name;
  std::int64_t stamp = 0;
  line >> topic >> stamp;
  auto message = std::make_shared<sensor_msgs::msg::JointState>();
  message->header.stamp.sec = std::int32_t(stamp / 1000000000);
  message->header.stamp.nanosec = std::uint32_t(stamp % 1000000000);
  while (line >> field >> name) {
    std::string number;
    line >> number;
    if (std::find(message->name.begin(), message->name.end(), name) == message->name.end()) {
      message->name.push_back(name);
    }
    auto &values = field == "position"   ? message->position
                   : field == "velocity" ? message->velocity
                                         : message->effort;
    values.push_back(std::stod(number));
  }
  node.joints.at(topic)->call(message);
}

inline void move_clock(Node &node, std::int64_t time) {
  node.get_clock()->time = time;
  TimerBase &timer = *node.timer;
  if (time >= timer.due) {
    timer.due += timer.period * ((time - timer.due) / timer.period + 1);
    timer.call();
  }
}

inline void spin(const std::shared_ptr<Node> &node) {
  std::string text;
  while (std::getline(std::cin, text)) {
    std::istringstream line(text);
    std::string word;
    line >> word;
    if (word == "joint") {
      deliver_joint(*node, line);
    } else if (word == "string") {
      std::string topic, said;
      line >> topic >> said;
      auto message = std::make_shared<std_msgs::msg::String>();
      message->data = said;
      node->strings.at(topic)->call(message);
    } else if (word == "at") {
      std::int64_t time = 0;
      line >> time;
      move_clock(*node, time);
    } else {
      throw std::runtime_error("the script says " + text);
    }
  }
}

}  // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) \
  ((void)rclcpp::name_of(logger), (void)std::fprintf(stderr, __VA_ARGS__), (void)std::fputc('\n', stderr))
