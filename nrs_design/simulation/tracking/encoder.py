"""An encoder that rounds to its counts."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from nrs_design.models.robot.vectors import Array


@dataclass(frozen=True, slots=True)
class Encoder:
    """Absolute encoder at the output of the gearhead (MagAlpha MA707, thesis 4.1).

    Parameters
    ----------
    ratio : float
        Turns of the encoder per turn of the joint.
    counts : int or None
        Per turn of the encoder; None does not round.
    """

    ratio: float
    counts: int | None

    def read(self, joints: Array) -> Array:
        """Return what encoders say of joint angles: their own angles in rad, to the count."""
        angle = self.ratio * joints
        if self.counts is None:
            return angle
        count = 2 * pi / self.counts
        return np.asarray(count * np.round(angle / count))
