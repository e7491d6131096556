"""Models of the actuator, the motion loop and what the robot touches."""
