"""The robot: geometry, kinematics, dynamics, simplified dynamics and balance (thesis 3 and 4)."""
