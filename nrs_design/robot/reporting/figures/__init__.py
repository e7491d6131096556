"""Figures of a robot."""
