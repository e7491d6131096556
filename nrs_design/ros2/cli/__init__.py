"""Commands of ROS 2."""
