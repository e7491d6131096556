"""Poses in the workspace of the thesis robot."""

import numpy as np

POSES = np.random.default_rng(8).uniform((-0.24, -0.33, 0.155), (0.24, 0.33, 0.24), (20, 3))
