"""The mode logic as a processor runs it: comparisons in single precision, and a count of samples.

Thresholds are rounded away from each other, and times up to whole samples: what is shown for those
of the spec holds for these.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from typing import Self

from nrs_design.controllers.float32 import float32_not_above, float32_not_below
from nrs_design.errors import DesignError
from nrs_design.spec.threshold_logic import LogicSwitchSpec, ThresholdLogicSpec

# The count of samples stops there.
LONGEST = 2**32 - 1
UNITS = {"command": "rad/s", "torque": "N*m"}


@dataclass(frozen=True, slots=True)
class SignalBound:
    """One side of a threshold."""

    signal: str  # ``command`` or ``torque``, positive towards the tissue
    is_lower: bool  # True for a least value, false for a largest value
    threshold: Fraction  # A single-precision number in rad/s or N m


@dataclass(frozen=True, slots=True)
class StepSwitch:
    """A switch, which is made when all of its bounds hold: modes by number."""

    source: int
    target: int
    bounds: tuple[SignalBound, ...]


@dataclass(frozen=True, slots=True)
class StepLogic:
    """Which mode is active, sample by sample."""

    start: int  # Mode at first
    signals: tuple[str, ...]  # Names of the signals
    switches: tuple[StepSwitch, ...]  # The first that may be made is
    hold_samples: tuple[int, ...]  # For how many samples each mode is held

    @classmethod
    def create(cls, logic: ThresholdLogicSpec, modes: Sequence[str], period: Fraction) -> Self:
        """Return the logic of a spec in samples of a period in s.

        A `DesignError` if a threshold is beyond single precision, or a time too long to be counted.
        """
        signal_names = {name for switch in logic.switches for name in switch.conditions}
        dwells = {name: logic.stay(name) for name in modes}
        samples = [0 if stay is None else ceil(stay.value / period) for stay in dwells.values()]
        if max(samples) > LONGEST:
            raise DesignError(
                "a controller is held for more samples than 32 bits count",
                remedy="shorten `hold`",
                at=("mode_logic", "hold"),
            )
        return cls(
            modes.index(logic.start),
            tuple(name for name in UNITS if name in signal_names),
            tuple(_switch(switch, modes) for switch in logic.switches),
            tuple(samples),
        )

    def step(self, mode: int, count: int, signals: Mapping[str, float]) -> tuple[int, int]:
        """Return mode and count after a sample.

        Before it, `mode` has been active for `held` samples. Signals are single-precision numbers;
        one that is no number is no reason to switch.
        """
        if mode >= len(self.hold_samples):
            return self.start, 1
        if count >= self.hold_samples[mode]:
            for switch in self.switches:
                if switch.source == mode and all(_holds(b, signals) for b in switch.bounds):
                    return switch.target, 1
        return mode, min(count + 1, LONGEST)


def _holds(bound: SignalBound, signals: Mapping[str, float]) -> bool:
    value, threshold = signals[bound.signal], float(bound.threshold)
    return value >= threshold if bound.is_lower else value <= threshold


def _switch(switch: LogicSwitchSpec, modes: Sequence[str]) -> StepSwitch:
    bounds: list[SignalBound] = []
    for name, condition in switch.conditions.items():
        if condition.above is not None:
            bounds.append(SignalBound(name, True, float32_not_below(condition.above.not_below)))
        if condition.below is not None:
            bounds.append(SignalBound(name, False, float32_not_above(condition.below.not_above)))
    return StepSwitch(modes.index(switch.source), modes.index(switch.target), tuple(bounds))
