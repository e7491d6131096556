"""The mode logic on the robot: which controller is active, by thresholds and a timer."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Self

from nrs_design.proof.bounds import lower_float, upper_float
from nrs_design.spec.threshold_logic import LogicSwitchSpec, ThresholdLogicSpec


@dataclass(frozen=True, slots=True)
class LogicState:
    """What the logic remembers from one step to the next."""

    controller: str  # The active one
    since: float = 0.0  # Time since the switch to it, or since the start, in s


@dataclass(frozen=True, slots=True)
class _Switch:
    target: str
    # Lowest and highest value of each signal.
    bounds: Mapping[str, tuple[float, float]]

    def is_due(self, signals: Mapping[str, float]) -> bool:
        """Tell whether all conditions hold; a value that is no number fulfils none."""
        return all(low <= signals[name] <= high for name, (low, high) in self.bounds.items())


@dataclass(frozen=True, slots=True)
class ThresholdLogic:
    """Thresholds and timers of the logic, in SI units.

    Thresholds are rounded away from each other, and timers up: what is shown for those of the spec
    holds for these.
    """

    initial: str  # Controller at first
    # From each controller, in order: targets and bounds of the signals.
    switches: Mapping[str, tuple[_Switch, ...]]
    stays: Mapping[str, float]  # For how long the timer holds a controller, in s

    @classmethod
    def of(cls, logic: ThresholdLogicSpec) -> Self:
        """Return the logic that a spec declares."""
        names = logic.controllers
        stays = {name: stay for name in names if (stay := logic.stay(name)) is not None}
        return cls(
            logic.start,
            {
                name: tuple(
                    _switch_of(switch) for switch in logic.switches if switch.source == name
                )
                for name in names
            },
            {name: upper_float(stay.value) for name, stay in stays.items()},
        )

    def conditions(self) -> Iterator[tuple[str, str, Mapping[str, tuple[float, float]]]]:
        """Yield every switch: the controller that is left, the next one, bounds of the signals."""
        for source, switches in self.switches.items():
            yield from ((source, switch.target, switch.bounds) for switch in switches)

    def start(self) -> LogicState:
        """Return the state at the start; the timer runs from there."""
        return LogicState(self.initial)

    def step(self, state: LogicState, elapsed: float, signals: Mapping[str, float]) -> LogicState:
        """Return the next state: another controller, if a switch to it is due and the timer is out.

        Parameters
        ----------
        state : LogicState
            After the step before.
        elapsed : float
            Time since then in s.
        signals : mapping of str to float
            Values that the logic sees: ``command`` in rad/s and ``torque`` in N m, as far as the
            spec speaks of them; both positive towards the tissue.
        """
        since = state.since + elapsed
        if since >= self.stays.get(state.controller, 0.0):
            for switch in self.switches[state.controller]:
                if switch.is_due(signals):
                    return LogicState(switch.target)
        return LogicState(state.controller, since)


def _switch_of(switch: LogicSwitchSpec) -> _Switch:
    bounds = {}
    for name, condition in switch.conditions.items():
        low, high = float("-inf"), float("inf")
        if condition.above is not None:
            low = upper_float(condition.above.not_below)
        if condition.below is not None:
            high = lower_float(condition.below.not_above)
        bounds[name] = (low, high)
    return _Switch(switch.target, bounds)
