"""Motion control of the robot's joints (thesis 4.2 to 4.4), and the same as operations."""
