"""Kinematics, dynamics and motion control of a robot, and bounds on what its links do."""
