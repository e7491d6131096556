"""Choosing the gains of the motion control of a robot."""
