"""Chapter 4.4: counter-masses and springs of the side legs."""

from __future__ import annotations

from nrs_design.models.robot import design_balance
from nrs_design.models.robot.balance import LegBalance
from nrs_design.reproduction.comparison import (
    ReproducedValue,
    Tolerance,
    misprint,
    omitted,
    reproduced,
)
from nrs_design.reproduction.neuroboscope import robot, robot_spec

# Thesis 4.4: M_c, M_b, M_a in g, B_a in mm, k in N/mm, A0C_A in mm.
LEFT = ("843.5", "1301.1", "2887.9", "113.5", "1.8041")
RIGHT = ("844.1", "1302.4", "2892", "113.5", "1.5919")
TOLERANCE = Tolerance(5e-4)


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute counter-masses, springs and the two misprinted lengths."""
    ours = design_balance(robot_spec(), robot())
    # What the printed spring constant of the right leg asks for.
    attachment = ours.right.stiffness * ours.right.spring_on_crank / (1e3 * float(RIGHT[4]))
    return (
        *_leg("left", LEFT, ours.left, "133.49"),
        *_leg("right", RIGHT, ours.right, "133.48"),
        *_distances(ours.left),
        misprint(
            "spring on the right crank, A0C_A",
            "4.4",
            "26.66",
            1e3 * attachment,
            "mm",
            Tolerance(5e-4),
            right="29.66",
            note="The printed spring constant needs 29.66 mm; one digit differs.",
        ),
        omitted(
            "payload of each side leg, m_p",
            "4.4",
            "442.8",
            "g",
            "Half of the platform of table 3.1 is 398.6 g; 88.4 g of the two are not explained.",
        ),
    )


def _distances(ours: LegBalance) -> tuple[ReproducedValue, ...]:
    """Return where the printed counter-masses must sit; the same in both legs."""
    return tuple(
        reproduced(name, "4.4", printed, 1e6 * mass * at / float(text), "mm", Tolerance(5e-3))
        for name, printed, text, mass, at in (
            ("B_c C, left leg", "115", LEFT[0], ours.arm_mass, ours.arm_distance),
            ("B_b A, left leg", "220", LEFT[1], ours.coupler_mass, ours.coupler_distance),
        )
    )


def _leg(
    name: str, printed: tuple[str, ...], ours: LegBalance, distance: str
) -> tuple[ReproducedValue, ...]:
    masses = {"M_c": ours.arm_mass, "M_b": ours.coupler_mass, "M_a": ours.total_mass}
    note = (
        "With the arm's center of mass 75.4 mm from the coupler's end; table 3.1 has 65.6 mm."
        if name == "left"
        else ""
    )
    return (
        *(
            reproduced(f"{key}, {name} leg", "4.4", text, 1e3 * mass, "g", TOLERANCE, note=note)
            for (key, mass), text in zip(masses.items(), printed[:3], strict=True)
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
        ),
        reproduced(
            f"spring constant, {name} leg",
            "4.4",
            printed[4],
            1e-3 * ours.stiffness,
            "N/mm",
            TOLERANCE,
        ),
    )
