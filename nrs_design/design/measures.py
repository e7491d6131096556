"""Measures of a design, and their usual limits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from enum import StrEnum
from fractions import Fraction

from nrs_design.models.axis import current, unit
from nrs_design.spec.goals import GoalsSpec
from nrs_design.spec.model import declared_in

_DIGITS = 4


# Explanations of the worst values.
MEANING = (
    "Margins: the worst of the loop that certify-switching is about, at the nominal values and at "
    "every corner of the ranges of all contacts and the motor, each of them constant; "
    "sampled, at every age of the force sample, always the same.",
    "Errors, transparency and effort: the worst with the designed gains, in the environment that "
    "the controller is designed for, at the nominal values and every corner of its ranges and of "
    "those of the motor.",
    "Computed in floating point, not a proof; between corners a goal is looked at in some points.",
)
# Explanations of further columns of an impedance design.
LIMIT_MEANING = (
    "k limit: one constant stiffness of the environment of the design, up to which the same loop "
    "is stable at every corner of the other ranges."
)
COST_MEANING = (
    "Cost: that of the thesis, of its loop G Ze H Y at nominal values, in continuous time and "
    "without a load of the motor; gains are chosen by it."
)


def computed(proved: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Yield how the values of controllers were found, and what is proved over all ranges."""
    names: dict[str, list[str]] = {}
    for name, titles in proved.items():
        if titles:
            names.setdefault(", ".join(titles), []).append(name)
    for statement, labels in names.items():
        yield (
            f"Proved in exact arithmetic for all values in the ranges, each of them constant, of "
            f"{', '.join(labels)}: {statement}."
        )
    yield f"{'All else: computed' if names else 'Computed'}{MEANING[-1].removeprefix('Computed')}"


class GoalStanding(StrEnum):
    """How a goal for a measure stands."""

    MET = "met"
    NOT_JUDGED = "not judged"  # Neither a miss nor a proof in the ranges
    MISSED = "missed"

    @property
    def text(self) -> str:
        """The same for people."""
        return "MISSED" if self is GoalStanding.MISSED else str(self)


@dataclass(frozen=True, slots=True)
class Measure:
    """One measure of a controller."""

    goal: str  # Key of the goal in a spec
    title: str  # In a few words, such as ``phase margin``
    # In which it is shown, and shown value over SI value; empty for a number.
    unit: str = ""
    scale: float = 1.0
    turning: bool = False  # Whether both are those of an axis that turns, in deg
    doubtful: float | None = None  # SI value beyond which a design without a goal is doubted

    @property
    def upper(self) -> bool:
        """True if the goal is an upper limit, false if it is a lower one."""
        return declared_in(GoalsSpec)[self.goal].stronger == "smaller"

    def text(self, value: float | Fraction) -> str:
        """Write a value with four digits, rounded to its unfavorable side."""
        if math.isnan(value):
            return "not computed"
        if not math.isfinite(value):
            return "unbounded" if self.upper else "unlimited"
        rounding = ROUND_CEILING if self.upper else ROUND_FLOOR
        context = Context(prec=_DIGITS, rounding=rounding)
        scale, unit_text = self._unit
        if isinstance(value, Fraction):
            exact = value * self.exact_scale
            quotient = context.divide(Decimal(exact.numerator), Decimal(exact.denominator))
        else:
            quotient = context.create_decimal(Decimal(value * scale))
        return f"{quotient.normalize():f} {unit_text}".rstrip()

    @property
    def usual(self) -> str:
        """What is usual, such as ``at most 2``, for a measure that has a doubtful value."""
        assert self.doubtful is not None
        return self.goal_text(self.doubtful)

    def goal_text(self, value: float) -> str:
        """Write a goal, such as ``at most 2``."""
        scale, unit_shown = self._unit
        shown = f"{value * scale:.6g} {unit_shown}".rstrip()
        return f"{'at most' if self.upper else 'at least'} {shown}"

    @property
    def exact_scale(self) -> Fraction:
        """Shown value over SI value, as the floating-point number that it is."""
        return Fraction(self._unit[0])

    @property
    def _unit(self) -> tuple[float, str]:
        """Scale and unit on the current axis."""
        if not self.turning:
            return self.scale, self.unit
        return current().fine if self.unit.startswith("deg") else self.scale, unit(self.unit)

    @property
    def si_unit(self) -> str:
        """The unit of its value in SI."""
        si = {"deg": "rad", "deg/s": "rad/s", "ms": "s"}.get(self.unit, self.unit)
        return unit(si) if self.turning else si

    def violation(self, value: float, goal: float) -> float:
        """Return by which part a value misses a goal; not positive where it is met."""
        better, worse = (goal, value) if self.upper else (value, goal)
        return worse / better - 1 if better else math.inf


# Limits: stability margin 0.5 to 0.8 (1/Ms), gain margin 2 to 5 and phase margin 30 to 60 degrees
# are called reasonable by Astrom and Murray, Feedback Systems, 2nd ed., section 10.3; Ms of 1.2 to
# 2.0 is usual in Astrom and Hagglund, Advanced PID Control (2006). The two errors have limits of
# ours, see docs/design/goals.md; a delay margin is to be held against the delay that there is.
SENSITIVITY_PEAK = Measure("max_sensitivity_peak", "sensitivity peak Ms", doubtful=2.0)
GAIN_MARGIN = Measure("min_gain_margin", "gain margin", doubtful=2.0)
PHASE_MARGIN = Measure(
    "min_phase_margin", "phase margin", unit="deg", scale=180 / math.pi, doubtful=math.radians(30)
)
DELAY_MARGIN = Measure("min_delay_margin", "delay margin", unit="ms", scale=1e3)
DISK_MARGIN = Measure("min_disk_margin", "disk margin")
IMPEDANCE_ERROR = Measure("max_impedance_error", "factor off the desired impedance", doubtful=2.0)
CREEP = Measure("max_creep", "creep in free motion", "deg/s", turning=True)
CREEP_ANGLE = Measure("max_creep_angle", "way of creep in free motion", "deg", turning=True)
FORCE_ERROR = Measure("max_force_error", "steady force error over command", doubtful=0.5)
# A hand moves the robot: shown only with a goal.
TRANSPARENCY = Measure("min_transparency", "share of the motion of the hand that is followed")
HAND_EFFORT = Measure("max_hand_effort", "effort of the hand", unit="N*m*s/rad", turning=True)

MARGINS = (SENSITIVITY_PEAK, GAIN_MARGIN, PHASE_MARGIN, DELAY_MARGIN, DISK_MARGIN)
IMPEDANCE_MEASURES = (*MARGINS, IMPEDANCE_ERROR)
HAND_MEASURES = (TRANSPARENCY, HAND_EFFORT)
# Taken with the designed gains only, in the environment that they are designed for.
CONTACT_MEASURES = (IMPEDANCE_ERROR, FORCE_ERROR, *HAND_MEASURES)
CREEP_MEASURES = (CREEP, CREEP_ANGLE)  # Only with known errors of the force signal
# What rises or falls with each parameter throughout, as long as the loop is stable: the worst is at
# a corner.
MONOTONE = (*CREEP_MEASURES, FORCE_ERROR)
FORCE_MEASURES = (*MARGINS, FORCE_ERROR)
