"""Chapter 7: the admittances of the hands-on controlled robot, table 7.1."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction

from nrs_design.controllers.laws import Admittance
from nrs_design.design.passivity import passive_band
from nrs_design.design.root_locus import motion_loop_response
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Found, Recomputed

# Mt in kg m^2 and Bt in kg m^2/s of each experiment.
ADMITTANCES = ((1, 4), (2, 4), (3, 4), (1, 8), (2, 8), (3, 8))


def results() -> Iterable[Found]:
    """Compute the poles of G Y, the hand that destabilizes the robot, and where it is passive."""
    motion = motion_loop_response(thesis.EXACT_LOOP).poles
    laws = (Admittance(Fraction(Mt), Fraction(Bt)) for Mt, Bt in ADMITTANCES)
    bands = [passive_band(thesis.AXIS, law, {}) for law in laws]
    passive = tuple(float(band.passive or 0) / (2 * math.pi) for band in bands)
    return (
        Recomputed(
            tuple(-Bt / Mt for Mt, Bt in ADMITTANCES), all(pole.real < 0 for pole in motion)
        ),
        tuple(thesis.stiffness_limit(Mt, Bt) for Mt, Bt in ADMITTANCES),
        Recomputed(passive, all(band.broken is not None for band in bands)),
    )
