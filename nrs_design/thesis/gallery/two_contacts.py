"""Figures 6.28 to 6.34: soft tissue on one side, a medical tool on the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.reporting.document import Illustration
from nrs_design.reporting.figures.panels import Curve, Panel, PanelColumn, draw_panels
from nrs_design.reporting.simulation import four_digits_up
from nrs_design.simulation.metrics import impedance_rmse
from nrs_design.simulation.run import Run
from nrs_design.thesis.gallery.counterpart import (
    Counterpart,
    Reproducibility,
    Statement,
    measured,
    stated,
    taken,
)
from nrs_design.thesis.gallery.panels import (
    ENGINE,
    depth_panel,
    impedance_panel,
    met,
    speed_panel,
    stays,
    torque_panel,
)
from nrs_design.thesis.interaction import DESIRED, PROFILE, tissue_and_tool, two_contacts
from nrs_design.thesis.thesis import TORQUE

_GIVEN = (
    "motion loop of 4.29 and 4.30, k_soft 43.0356 and k_stiff 61.6608 N m/rad (6.4.1)",
    "Mt 0.01 kg m^2; Bt 2.15 N m s/rad in tissue, 2.11 against the tool (6.4.1), switched by what "
    "is met",
)

# An instant of a run and one of its command are the same if they are so near, s.
_LATE = 0.1


@dataclass(frozen=True, slots=True)
class TwoContactsExperiment:
    """One of the two experiments of 6.4.2."""

    # figure, axis: which.
    figure: str
    axis: str
    # Into soft tissue, out of it, onto the stiff specimen: s, as printed.
    times: tuple[str, str, str]
    # RMSE of the displayed impedance in soft and stiff contact, N m s/rad, as printed.
    errors: tuple[str, str]
    places: tuple[float, float]  # Angles where tissue and tool begin in the run, deg
    command: tuple[tuple[float, float], ...]  # Of the run: s and deg/s


EXPERIMENTS = (
    TwoContactsExperiment(
        "6.33",
        "phi",
        ("2", "18", "20.9"),
        ("0.12335", "0.4621"),
        (1.98, -0.45),
        ((0, 1), (4, 1), (8, 4), (12, 4), (17.95, 0), (18.95, -1), (22, -1), (25, -4), (29, -4),
         (33, 0), (34, 1), (35, 1)),
    ),
    TwoContactsExperiment(
        "6.34",
        "psi",
        ("6.7", "31.7", "37.8"),
        ("0.5333", "0.17"),
        (5.18, -0.44),
        ((0, 0), (1, 0), (2, 1), (10, 1), (16, 4), (22, 4), (31.66, 0), (32.66, -1), (40, -1),
         (44, -4), (50, -4), (55, 0), (56, 1), (58, 1)),
    ),
)  # fmt: skip


def counterparts() -> tuple[Counterpart, ...]:
    """Simulate the desired motion, and both experiments."""
    return (_desired(), *map(_experiment, EXPERIMENTS))


def _desired() -> Counterpart:
    run = tissue_and_tool()
    return Counterpart(
        shows={
            "6.28": "Pictures of the operation and of tissue and tool; no record",
            "6.29": "Drawing of the scene: tissue from B on, tool from D on",
            "6.30": "The surgeon's speed command; instants named, not timed",
            "6.31": "The endoscope's location on that command",
            "6.32": "The torque on that command",
        },
        section="6.4",
        title="into tissue, out, onto the tool, and off it",
        statements=_order(run),
        given=(*_GIVEN, "shape and largest speed, 8 deg/s, of the command (figures 6.7 and 6.30)"),
        chosen=("the times of the command; tissue from 8 deg on, the tool from -2 deg down",),
        illustrations=(
            Illustration(
                "figure-6-30-record",
                "Counterpart of figures 6.29 to 6.32: command, location and torque",
                f"Shaded: whose controller is in force, by what was met last. {ENGINE}",
                draw_panels([_scene(run)]),
            ),
        ),
        runs={"figure-6-30": run.response},
    )


def _scene(run: Run) -> PanelColumn:
    response = run.response
    ends = response.t[[0, -1]]
    angle = Panel(
        "Angle [rad]",
        (
            Curve(response.t, response["angle"], "angle of phi", 0),
            Curve(ends, np.radians([8, 8]), "soft tissue begins (B)", 2),
            Curve(ends, np.radians([-2, -2]), "tool begins (D)", 3),
        ),
    )
    speed = speed_panel(response, "phi", of_the_axis=False)
    panels = (speed, angle, torque_panel(response, both=True))
    return PanelColumn("", panels, (0.0, float(response.t[-1])), stays(run))


def _order(run: Run) -> tuple[Statement, ...]:
    torque, t = run.response["torque"], run.response.t
    t2, t4, t6, t8 = (time for time, _, _ in run.contacts)
    t3, t7 = float(t[torque.argmax()]), float(t[torque.argmin()])
    soft, stiff = float(torque.max()), -float(torque.min())
    # Of the command: when it is largest in tissue, and when it is zero.
    largest, zero = PROFILE[3][0], PROFILE[4][0]
    return (
        Statement(
            "figure 6.28",
            "pictures",
            "none",
            Reproducibility.HARDWARE_ONLY,
            "a run has a scene of angles and stiffnesses, that of figure 6.29",
        ),
        stated(
            "order: tissue met t2, largest torque t3, lost t4; tool met t6, largest torque t7, "
            "lost t8",
            "t2 < t3 < t4 < t6 < t7 < t8",
            ", ".join(f"{time:.2f}" for time in (t2, t3, t4, t6, t7, t8)) + " s",
            t2 < t3 < t4 < t6 < t7 < t8,
        ),
        stated(
            "largest torque in tissue t3",
            "when the largest command is given",
            f"{1e3 * (t3 - largest):.0f} ms after it",
            abs(t3 - largest) < _LATE,
        ),
        stated(
            "tissue lost t4",
            "when the command is 0",
            f"{1e3 * (t4 - zero):.0f} ms after it",
            abs(t4 - zero) < _LATE,
        ),
        stated("largest torque in tissue, N m", "T_max, 0.3", four_digits_up(soft), soft <= TORQUE),
        stated(
            "largest torque against the tool, N m",
            "T_max, 0.3",
            four_digits_up(stiff),
            stiff <= TORQUE,
            "the tool is met at the largest speed here, and the torque overshoots before the "
            "robot has given way",
        ),
    )


def _experiment(one: TwoContactsExperiment) -> Counterpart:
    run = two_contacts(*one.places, *one.command)
    response, name = run.response, f"figure-6-{one.figure[2:]}"
    soft, stiff = _errors(run)
    panels = (
        speed_panel(response, one.axis),
        torque_panel(response, both=True),
        depth_panel(response),
        impedance_panel(response),
    )
    times = tuple(map(float, one.times))
    column = PanelColumn("", panels, (0.0, float(response.t[-1])), stays(run), times)
    switched = [time for time, controller in run.switches if controller == "tool"]
    why = "it is that of the command's course, which is not printed"
    return Counterpart(
        shows={one.figure: f"Commanded speed of {one.axis} and torque, soft and stiff specimens"},
        section="6.4.2",
        title=f"soft specimen, then stiff specimen, {one.axis}",
        statements=(
            taken("into the soft specimen, s", one.times[0], met(run, 0)),
            taken("out of it, s", one.times[1], met(run, 1)),
            taken("onto the stiff specimen, s", one.times[2], met(run, 2)),
            stated(
                "parameters are switched",
                "when the stiff specimen is met",
                f"at {switched[0]:.4g} s",
                abs(switched[0] - met(run, 2)) < 1e-6,
            ),
            measured(
                "RMSE in soft contact, N m s/rad", one.errors[0], soft, why, Reproducibility.OMITTED
            ),
            measured(
                "RMSE in stiff contact, N m s/rad",
                one.errors[1],
                stiff,
                why,
                Reproducibility.OMITTED,
            ),
            Statement(
                "which contact has the larger error",
                "stiff" if one.axis == "phi" else "soft",
                "soft" if soft > stiff else "stiff",
                Reproducibility.HARDWARE_ONLY,
                "the printed axes contradict each other, and the model has one for both",
            ),
        ),
        given=(*_GIVEN, "the three instants; the robot is in no contact at the start"),
        chosen=(
            "the course of the command, up to 4 deg/s, the held slider of the example in 6.2",
            f"where the specimens begin, {one.places[0]} and {one.places[1]} deg",
        ),
        illustrations=(
            Illustration(
                f"{name}-record",
                f"Counterpart of figure {one.figure}: command, torque, depth, displayed impedance",
                f"Torque of the stiff specimen, which is met from above, is negative. {ENGINE}",
                draw_panels([column]),
            ),
        ),
        runs={name: response},
    )


def _errors(run: Run) -> tuple[float, float]:
    """Return the RMSE of the displayed impedance in soft and in stiff contact."""
    response = run.response
    parts = (np.maximum(response["torque"], 0.0), np.minimum(response["torque"], 0.0))
    soft, stiff = (impedance_rmse(response.t, response["hand"], part, DESIRED) for part in parts)
    assert soft is not None
    assert stiff is not None
    return soft, stiff
