"""Control laws of the robot, with the gains that ship."""
