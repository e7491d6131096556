"""The one way in to python-control, which imports matplotlib: behind `nrs_design.plotting`."""

from __future__ import annotations

# The order matters.
from nrs_design import plotting  # isort: split

import control

__all__ = ["control", "plotting"]
