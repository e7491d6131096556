"""Simulation of switched loops."""
