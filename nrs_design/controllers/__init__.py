"""What runs on the robot: control laws with the gains that ship."""
