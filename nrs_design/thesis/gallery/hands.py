"""Section 7.2.2: the six moves by hand, which the thesis tells in percent and does not draw."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from nrs_design.reporting.document import Illustration
from nrs_design.reporting.figures.panels import Curve, Panel, PanelColumn, draw_panels
from nrs_design.simulation.time_response import Array
from nrs_design.thesis.gallery.counterpart import (
    Counterpart,
    Reproducibility,
    Statement,
    stated,
)
from nrs_design.thesis.hand_runs import (
    HAND,
    PAIRS,
    SPEEDS,
    TORQUES,
    WAY,
    HandRun,
    changes,
    move,
)
from nrs_design.thesis.hands_on import ADMITTANCES

_SIGNALS: tuple[tuple[str, Callable[[HandRun], Array]], ...] = (
    ("Angle [rad]", lambda run: run.angle),
    ("Speed [rad/s]", lambda run: run.velocity),
    ("Torque [N m]", lambda run: run.torque),
)
_WHY = "torque and speed of the handle are not printed"


def counterparts() -> tuple[Counterpart, ...]:
    """Simulate the six moves with both hands."""
    pushed = [move(*admittance) for admittance in ADMITTANCES]
    led = [move(*admittance, HAND) for admittance in ADMITTANCES]
    return (
        Counterpart(
            shows={},
            section="7.2.2",
            title="six moves by hand",
            statements=(*_signs(pushed, led), *_changes(pushed, led)),
            given=(
                "motion loop of 4.29 and 4.30; Mt and Bt of table 7.1; phi goes through 15 deg",
                "0.3 N m and 8 deg/s, the largest torque and speed of 6.3.1.1; 1002 N/m, surgeons' "
                "hands (cited in 6.1), at 240 mm",
            ),
            chosen=(
                "how the hand moves the robot: it pushes with 0.3 N m throughout, or it moves on "
                "at 8 deg/s behind its stiffness",
            ),
            illustrations=(
                _illustrate("pushed", "A hand that pushes with 0.3 N m", pushed),
                _illustrate("led", "A hand that moves on at 8 deg/s behind 57.7 N m/rad", led),
            ),
            remark="Figures 7.1 to 7.4 of the thesis are a picture and schemes; it has no record "
            "of these experiments. The two hands are ends between which an operator is. Angles "
            "count in the direction of the move; the thesis goes to -15 deg.",
        ),
    )


def _signs(pushed: Sequence[HandRun], led: Sequence[HandRun]) -> tuple[Statement, ...]:
    speeds = changes(list(map(_mean_speed, pushed)))
    led_speeds = changes(list(map(_mean_speed, led)))
    totals = changes(list(map(_total_torque, pushed)))
    led_totals = changes(list(map(_total_torque, led)))
    return (
        stated(
            "more Mt or more Bt: mean speed",
            "less in every pair",
            f"pushed: less in {_count(speeds, -1)} of 7; led: in {_count(led_speeds, -1)}",
            all(change < 0 for change in speeds),
        ),
        stated(
            "more Mt or more Bt: total torque",
            "more in every pair but 5 to 6, approximately the same",
            f"pushed: more in {_count(totals, 1)} of 7; led: in {_count(led_totals, 1)}",
            all(change > 0 for change in totals),
        ),
    )


def _changes(pushed: Sequence[HandRun], led: Sequence[HandRun]) -> tuple[Statement, ...]:
    speeds, totals = (
        [changes([measure(run) for run in runs]) for runs in (pushed, led)]
        for measure in (_mean_speed, _total_torque)
    )
    return tuple(
        Statement(
            f"change of {name}, experiment {before + 1} to {after + 1}, %",
            f"{number:+d}" if number else "approximately the same",
            f"pushed {one:+.3g}, led {other:+.3g}",
            Reproducibility.OMITTED,
            _WHY,
        )
        for name, printed, found in (
            ("mean speed", SPEEDS, speeds),
            ("total torque", TORQUES, totals),
        )
        for (before, after), number, one, other in zip(PAIRS, printed, *found, strict=True)
    )


def _count(found: Sequence[float], sign: int) -> int:
    return sum(sign * change > 0 for change in found)


def _mean_speed(run: HandRun) -> float:
    return WAY / run.time


def _total_torque(run: HandRun) -> float:
    return run.effort.total


def _illustrate(name: str, title: str, runs: Sequence[HandRun]) -> Illustration:
    return Illustration(
        f"section-7-2-2-{name}",
        title,
        "Angle and speed of the robot and torque of the hand until 15 degrees are passed. The "
        "total torque of an experiment is the area between its last curve and zero.",
        draw_panels([_column(runs[:3], "1 to 3: Bt 4"), _column(runs[3:], "4 to 6: Bt 8")]),
    )


def _column(runs: Sequence[HandRun], title: str) -> PanelColumn:
    panels = tuple(
        Panel(
            label,
            tuple(
                Curve(run.t, signal(run), f"Mt {Mt} kg m²", look)
                for look, (run, Mt) in enumerate(zip(runs, (1, 2, 3), strict=True))
            ),
        )
        for label, signal in _SIGNALS
    )
    return PanelColumn(title, panels, (0.0, max(run.time for run in runs)))
