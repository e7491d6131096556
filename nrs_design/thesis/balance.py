"""Chapter 4.4: counter-masses and springs of the side legs."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.robot.models import design_balance
from nrs_design.robot.models.balance import LegBalance
from nrs_design.robot.models.neuroboscope import robot, robot_spec
from nrs_design.thesis.comparison import (
    ReproducedValue,
    Tolerance,
    fitted,
    misprint,
    omitted,
    reproduced,
)

# Thesis 4.4: M_c, M_b, M_a in g, B_a in mm, k in N/mm.
LEFT = ("843.5", "1301.1", "2887.9", "113.5", "1.8041")
RIGHT = ("844.1", "1302.4", "2892", "113.5", "1.5919")
# Printed arms of the counter-masses and payload of a leg, in m and kg.
ARM, COUPLER, PAYLOAD = 0.115, 0.220, 0.4428
TOLERANCE = Tolerance(5e-4)
ARMS = "B_c C = 114.93 mm, B_b A = 219.02 mm, both legs"


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute counter-masses, springs and the misprinted lengths."""
    ours = design_balance(robot_spec(), robot())
    return (
        *_leg("left", LEFT, ours.left, "133.49"),
        *_leg("right", RIGHT, ours.right, "133.48"),
        *_arms(ours.left),
        *_springs(ours.left, ours.right),
        _arm_mass(ours.left),
        omitted(
            "payload of each side leg, m_p",
            "4.4",
            "442.8",
            "g",
            "half of the platform of table 3.1 is 398.6 g, and 88.4 g of the two are not explained",
            ("4.4 m_p",),
        ),
    )


def _springs(left: LegBalance, right: LegBalance) -> tuple[ReproducedValue, ReproducedValue]:
    """Return where the printed spring constants must act on the cranks."""
    at = [
        1e3 * leg.stiffness * leg.spring_on_crank / (1e3 * float(printed[4]))
        for leg, printed in ((left, LEFT), (right, RIGHT))
    ]
    return (
        reproduced("spring on the left crank, A0C_A", "4.4", "26.13", at[0], "mm", TOLERANCE),
        misprint(
            "spring on the right crank, A0C_A",
            "4.4",
            "26.66",
            at[1],
            "mm",
            TOLERANCE,
            right="29.66",
            note="The printed spring constant needs 29.66 mm; one digit differs.",
            errata=("4.4 A0C_A",),
        ),
    )


def _arm_mass(left: LegBalance) -> ReproducedValue:
    """Return which center of mass of the left arm the printed counter-mass stands for."""
    arm = robot().legs[0]
    moment = 1e-3 * float(LEFT[0]) * left.arm_distance - PAYLOAD * arm.l3
    return misprint(
        "center of mass of the left arm, G_c C",
        "table 3.1",
        "65.6",
        1e3 * moment / arm.arm.mass,
        "mm",
        Tolerance(1e-2),
        right="75.4",
        note="M_c of 4.4 is that of 75.4 mm, which table 3.1 has for the right arm alone.",
        errata=("4.4 G_c",),
    )


def _arms(ours: LegBalance) -> tuple[ReproducedValue, ...]:
    """Return where the printed counter-masses must sit; the same in both legs."""
    return tuple(
        reproduced(
            name,
            "4.4",
            printed,
            1e6 * mass * at / float(text),
            "mm",
            TOLERANCE,
            right=right,
            note=f"The printed mass needs {right} mm. Rounded would be {float(right):.0f}.",
            errata=("4.4 arms",),
        )
        for name, printed, right, text, mass, at in (
            ("B_c C, left leg", "115", "114.94", LEFT[0], ours.arm_mass, ours.arm_distance),
            ("B_b A, left leg", "220", "219.03", LEFT[1], ours.coupler_mass, ours.coupler_distance),
        )
    )


def _leg(
    name: str, printed: tuple[str, ...], ours: LegBalance, distance: str
) -> tuple[ReproducedValue, ...]:
    rounded = _with_printed_arms(ours)
    masses = {"M_c": ours.arm_mass, "M_b": ours.coupler_mass, "M_a": ours.total_mass}
    plain = (rounded.arm_mass, rounded.coupler_mass, rounded.total_mass)
    arm = (
        " The left arm's center of mass is taken at 75.4 mm; table 3.1 has 65.6 mm."
        if name == "left"
        else ""
    )
    return (
        *(
            fitted(
                f"{key}, {name} leg",
                "4.4",
                text,
                1e3 * mass,
                "g",
                TOLERANCE,
                constants=ARMS,
                note=f"With the printed arms, 115 and 220 mm, it is {1e3 * without:.1f} g.{arm}",
            )
            for (key, mass), text, without in zip(masses.items(), printed[:3], plain, strict=True)
        ),
        misprint(
            f"B_a A_0, {name} leg",
            "4.4",
            printed[3],
            1e3 * ours.total_distance,
            "mm",
            Tolerance(1e-4),
            right=distance,
            note="One digit differs: the moments about the base joint give 133.5 mm.",
            errata=("4.4 B_a",),
        ),
        fitted(
            f"spring constant, {name} leg",
            "4.4",
            printed[4],
            1e-3 * ours.stiffness,
            "N/mm",
            TOLERANCE,
            constants=ARMS,
            note=f"With the printed arms it is {1e-3 * rounded.stiffness:.4f} N/mm.",
        ),
    )


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
