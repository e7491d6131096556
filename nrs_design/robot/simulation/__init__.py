"""Simulation of motion control against the full dynamics of the robot (thesis 4.2 to 4.4)."""
