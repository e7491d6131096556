"""Chapter 4.4: counter-masses and springs of the side legs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from nrs_design.robot.models.balance import LegBalance, design_balance
from nrs_design.robot.models.neuroboscope import robot, robot_spec
from nrs_design.thesis.comparison import Found, Recomputed

# Thesis 4.4: M_c and M_b in g, k in N/mm, of the left and the right leg.
LEFT, RIGHT = (843.5, 1301.1, 1.8041), (844.1, 1302.4, 1.5919)
# Printed arms of the counter-masses and payload of a leg, in m and kg.
ARM, COUPLER, PAYLOAD = 0.115, 0.220, 0.4428


def results() -> Iterable[Found]:
    """Recompute counter-masses, springs and the misprinted lengths."""
    ours = design_balance(robot_spec(), robot())
    left, arm = ours.left, robot().legs[0]
    moment = 1e-3 * LEFT[0] * left.arm_distance - PAYLOAD * arm.l3
    return (
        *_leg(left),
        *_leg(ours.right),
        1e6 * left.arm_mass * left.arm_distance / LEFT[0],
        1e6 * left.coupler_mass * left.coupler_distance / LEFT[1],
        *(
            leg.stiffness * leg.spring_on_crank / printed[2]
            for leg, printed in ((left, LEFT), (ours.right, RIGHT))
        ),
        1e3 * moment / arm.arm.mass,
    )


def _leg(ours: LegBalance) -> Iterator[Recomputed]:
    """Yield masses, distance and spring of a leg, with what the printed arms would give."""
    rounded = _with_printed_arms(ours)
    for mass in ("arm_mass", "coupler_mass", "total_mass"):
        without = f"{1e3 * getattr(rounded, mass):.1f}"
        yield Recomputed(1e3 * getattr(ours, mass), facts=(without,))
    yield Recomputed(1e3 * ours.total_distance)
    yield Recomputed(1e-3 * ours.stiffness, facts=(f"{1e-3 * rounded.stiffness:.4f}",))


def _with_printed_arms(ours: LegBalance) -> LegBalance:
    """Return the balance with 115 and 220 mm in place of the fitted arms; same moments."""
    M_c = ours.arm_mass * ours.arm_distance / ARM
    more = robot().legs[0].l2 * (M_c - ours.arm_mass)
    M_b = (ours.coupler_mass * ours.coupler_distance + more) / COUPLER
    added = M_c - ours.arm_mass + M_b - ours.coupler_mass
    moment = ours.total_mass * ours.total_distance + added * robot().legs[0].l1
    return replace(
        ours,
        arm_mass=M_c,
        coupler_mass=M_b,
        total_mass=ours.total_mass + added,
        stiffness=ours.stiffness * moment / (ours.total_mass * ours.total_distance),
    )
