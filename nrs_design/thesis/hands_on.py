"""Chapter 7: the admittances of the hands-on controlled robot, table 7.1."""

from __future__ import annotations

import math
from fractions import Fraction

from nrs_design.controllers.laws import Admittance
from nrs_design.design.passivity import passive_band
from nrs_design.design.root_locus import motion_loop_response
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import ReproducedValue, Tolerance, derived

# Mt in kg m^2 and Bt in kg m^2/s of each experiment.
ADMITTANCES = ((1, 4), (2, 4), (3, 4), (1, 8), (2, 8), (3, 8))
PRINTED = "Mt 1, 2, 3, 1, 2, 3; Bt 4, 4, 4, 8, 8, 8"


def rows() -> tuple[ReproducedValue, ReproducedValue, ReproducedValue]:
    """Compute the poles of G Y, the hand that destabilizes the robot, and where it is passive."""
    poles = tuple(-Bt / Mt for Mt, Bt in ADMITTANCES)
    motion = motion_loop_response(thesis.EXACT_LOOP).poles
    limits = tuple(thesis.stiffness_limit(Mt, Bt) for Mt, Bt in ADMITTANCES)
    laws = (Admittance(Fraction(Mt), Fraction(Bt)) for Mt, Bt in ADMITTANCES)
    bands = [passive_band(thesis.AXIS, law, {}) for law in laws]
    passive = tuple(float(band.passive or 0) / (2 * math.pi) for band in bands)
    return (
        derived(
            "pole of the admittance, each experiment",
            "table 7.1",
            poles,
            "1/s",
            printed=PRINTED,
            right=("-4", "-2", "-1.33333", "-8", "-4", "-2.66667"),
            tolerance=Tolerance(1e-5),
            holds=all(pole.real < 0 for pole in motion),
            note="With the poles of the motion loop all are stable, as 7.2.1 says, while nothing "
            "but the operator's torque acts.",
        ),
        derived(
            "largest stable stiffness of the hand, each experiment",
            "table 7.1",
            limits,
            "N m/rad",
            printed=PRINTED,
            right=("205.28", "214.206", "218.007", "389.547", "410.559", "421.715"),
            tolerance=Tolerance(1e-3),
            note="A hand that holds on is an environment. The thesis's own figures for surgeons' "
            "hands are 25.0 to 90.4 N m/rad.",
        ),
        derived(
            "frequency up to which the displayed admittance is passive, each experiment",
            "table 7.1",
            passive,
            "Hz",
            printed=PRINTED,
            right=("2.2625", "1.6435", "1.3553", "3.0617", "2.2625", "1.8799"),
            tolerance=Tolerance(1e-3),
            holds=all(band.broken is not None for band in bands),
            note="Decided by rigorous isolation of roots. A little above, it is not passive: G Y "
            "has relative degree two, so with an inertia it never is at all frequencies.",
        ),
    )
