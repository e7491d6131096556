"""Sweeps: one command for many values of a spec, point by point, kept and taken up again."""
