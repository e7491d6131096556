"""Figures 6.14 and 6.15: command and torque in soft tissue under one impedance controller."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.reporting.document import Illustration
from nrs_design.reporting.figures.panels import PanelColumn, draw_panels
from nrs_design.reporting.simulation import four_digits_up
from nrs_design.simulation.metrics import displayed_impedance, impedance_rmse
from nrs_design.simulation.run import Run
from nrs_design.thesis.gallery.counterpart import (
    Counterpart,
    Reproducibility,
    Statement,
    measured,
    taken,
)
from nrs_design.thesis.gallery.panels import (
    ENGINE,
    at,
    depth_panel,
    impedance_panel,
    met,
    speed_panel,
    torque_panel,
)
from nrs_design.thesis.interaction import DESIRED, admittance, into, run_scenario
from nrs_design.thesis.thesis import VELOCITY

# 6.2: so fast moves the robot in the thesis's example of a held slider, deg/s.
HELD = 4


@dataclass(frozen=True, slots=True)
class ImpedanceExperiment:
    """One of the two experiments of 6.3.1.2."""

    # figure, axis: which.
    figure: str
    axis: str
    contact: str  # When contact is made, s, as printed
    # Instants in s and displayed impedances in N m s/rad, as printed.
    impedances: tuple[tuple[float, str], ...]
    rmse: str  # N m s/rad, as printed
    tissue: float  # Angle where the tissue begins in the run, deg
    command: tuple[tuple[float, float], ...]  # Of the run: s and deg/s


def _press(begin: float, held: float, end: float) -> tuple[tuple[float, float], ...]:
    """Return a command that rises to `HELD`, is held about an instant, and leaves the tissue."""
    rise, fall = (begin, 1), (end, 0)
    return (rise, (held - 2, HELD), (held + 2, HELD), fall, (end + 0.5, -1), (end + 1, -1))


EXPERIMENTS = (
    ImpedanceExperiment(
        "6.14",
        "phi",
        "15",
        ((26, "2.1372"), (46, "2.0997"), (57, "2.1766")),
        "0.0595",
        9.48,
        ((0, 0), (5, 0), (6, 1), *_press(20, 26, 33), *_press(37, 46, 50), *_press(53, 57, 62),
         (65, 0)),
    ),
    ImpedanceExperiment(
        "6.15",
        "psi",
        "5.3",
        ((20, "2.0494"), (30, "2.0883"), (43, "2.1131")),
        "0.0444",
        3.78,
        ((0, 0), (1, 0), (2, 1), *_press(14, 20, 24), *_press(26.5, 30, 35), *_press(38, 43, 47),
         (50, 0)),
    ),
)  # fmt: skip


def counterparts() -> tuple[Counterpart, ...]:
    """Simulate both experiments."""
    return tuple(map(_counterpart, EXPERIMENTS))


def _counterpart(one: ImpedanceExperiment) -> Counterpart:
    run = run_scenario({"impedance": admittance("0", "2.15")}, into(one.tissue, *one.command))
    name = f"figure-{one.figure.replace('.', '-')}"
    return Counterpart(
        shows={one.figure: f"Commanded speed of {one.axis} and torque, soft specimen"},
        section="6.3.1.2",
        title=f"in and out of soft tissue, {one.axis}",
        statements=_statements(one, run),
        given=(
            "motion loop of 4.29 and 4.30, k_soft 43.0356 N m/rad, Mt 0 and Bt 2.15 N m s/rad "
            "(6.3.1.1)",
            f"contact at {one.contact} s; instants of the displayed impedance; no contact at first",
            "4 deg/s, the held slider of the example in 6.2",
        ),
        chosen=(
            "the course of the command: 1 deg/s up to the tissue, 4 deg/s for four seconds about "
            "each instant, straight lines between, out of the tissue at 1 deg/s",
            f"where the tissue begins, {one.tissue} deg",
        ),
        illustrations=(
            Illustration(
                f"{name}-record",
                f"Counterpart of figure {one.figure}: command, torque, depth, displayed impedance",
                "Crosses: what the thesis prints. Where the command rests, the model displays "
                f"Bt; while it changes, the depth lags by Bt/k = 50 ms. {ENGINE}",
                draw_panels([_column(one, run)]),
            ),
        ),
        runs={name: run.response},
    )


def _column(one: ImpedanceExperiment, run: Run) -> PanelColumn:
    response = run.response
    printed = [(instant, float(value)) for instant, value in one.impedances]
    panels = (
        speed_panel(response, one.axis),
        torque_panel(response),
        depth_panel(response),
        impedance_panel(response, printed),
    )
    instants = (float(one.contact), *(instant for instant, _ in one.impedances))
    return PanelColumn("", panels, (0.0, float(response.t[-1])), (), instants)


def _statements(one: ImpedanceExperiment, run: Run) -> tuple[Statement, ...]:
    response = run.response
    hand, torque = response["hand"], response["torque"]
    shown, _ = displayed_impedance(hand, torque)
    error = impedance_rmse(response.t, hand, torque, DESIRED)
    assert error is not None
    values = [(text, at(response, shown, instant)) for instant, text in one.impedances]
    low, high = min(text for text, _ in values), max(text for text, _ in values)
    return (
        taken("contact is made first, s", one.contact, met(run, 0)),
        *(
            measured(
                f"displayed impedance at {instant:g} s, N m s/rad",
                text,
                value,
                "at rest the model displays Bt",
            )
            for (instant, _), (text, value) in zip(one.impedances, values, strict=True)
        ),
        measured(
            "RMSE of the displayed impedance, N m s/rad",
            one.rmse,
            error,
            "it is that of the command's course, which the thesis moves by a slider and does not "
            "print",
            Reproducibility.OMITTED,
        ),
        Statement(
            "largest torque, N m",
            "safe (chapter 8); T_max is 0.3",
            four_digits_up(float(np.abs(torque).max())),
            Reproducibility.OMITTED,
            "at rest it is Bt times the command, whose size is not printed: "
            f"{2.15 * VELOCITY:.4f} at 8 deg/s",
        ),
        Statement(
            "scatter of the displayed impedance, N m s/rad",
            f"{low} to {high}",
            f"{min(v for _, v in values):.4f} to {max(v for _, v in values):.4f}",
            Reproducibility.HARDWARE_ONLY,
            "the model has no sensor noise, no joint clearance and one specimen",
        ),
    )
