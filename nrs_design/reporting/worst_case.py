"""The worst runs found, in display units."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.axis import current, labelled
from nrs_design.axis import unit as shown
from nrs_design.proof.bounds import lower, upper
from nrs_design.reporting.figures.run import BoundedSignal, draw_bounded_run
from nrs_design.simulation.run import common_lever_arm
from nrs_design.simulation.switched import SwitchedRun
from nrs_design.simulation.time_response import Signal, TimeResponse
from nrs_design.simulation.worst_outputs import DEFLECTION, output_values, pushes_only

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.pipeline.scenarios import WorstCase
    from nrs_design.proof.channels import Output
    from nrs_design.simulation.norms import Array
    from nrs_design.simulation.worst_case import WorstRun
    from nrs_design.spec import InteractionDesignSpec

COLUMNS = ("", "worst found", "unit", "limit", "certified bound", "bound / found")
MEANING = (
    "An adversary chose controllers, contact, delay and disturbances within what the spec allows. "
    "He began at rest, or settled under what he held for long: pressed in, or on the way to a "
    "surface. What he found may happen in the model, and is a lower bound of the worst that may; "
    "the certified bound is an upper one. In his runs a surface that is lost stays in its place. "
    "The limit of the velocity is that of its command; the axis itself may go beyond."
)
NO_BOUND = "No bound is certified beside it: the worst that may happen may be any larger."
UNDECLARED = (
    "The spec names no disturbances, so the velocity command took any course up to its limit; "
    "with `disturbances` a bound can be certified."
)
ABOVE = " (above)"
# Which effects the adversary does not use.
LEFT_OUT = "roundings of the law, jitter, noise without a bound, and the limit of the command"
_COMMAND = "velocity command"


@dataclass(frozen=True, slots=True)
class WorstValue:
    """Worst value found of one quantity, its limit and certified bound; SI."""

    # Such as ``force`` in ``N*m``.
    name: str
    unit: str
    value: float  # That was found
    # limit, bound: of the spec, and certified.
    limit: float | None
    bound: float | None

    @property
    def ratio(self) -> float | None:
        """Certified bound over what was found; None without either."""
        return None if self.bound is None or not self.value else self.bound / self.value

    @property
    def exceeds(self) -> bool:
        """Whether what was found is beyond the limit."""
        return self.limit is not None and self.value > self.limit


def found_in(case: WorstCase) -> tuple[WorstValue, ...]:
    """Return the worst value found of each quantity."""
    return tuple(
        WorstValue(
            run.output.name,
            run.output.unit,
            run.value,
            case.limits.get(run.output.name),
            case.bounds.get(run.output.name),
        )
        for run in case.runs
    )


def meaning(case: WorstCase) -> str:
    """Say what the numbers mean."""
    return MEANING if case.bounds else f"{MEANING.partition(';')[0]}. {NO_BOUND}"


def worst_rows(case: WorstCase, spec: InteractionDesignSpec) -> list[list[str]]:
    """Return rows for `COLUMNS`: what was found rounded down, bounds rounded up."""
    rows, lever_arm = [], common_lever_arm(spec, spec.touched)
    for item in found_in(case):
        factor, unit = scale_of(item.name, item.unit, lever_arm)
        limit = "–" if item.limit is None else f"{factor * item.limit:.4g}"
        bound = "–" if item.bound is None else upper(Fraction(factor * item.bound), 4)
        ratio = "–" if item.ratio is None else upper(Fraction(item.ratio), 3)
        found = lower(Fraction(factor * item.value), 4)
        if item.exceeds:
            found += ABOVE
        rows.append([item.name, found, unit, limit, bound, ratio])
    return rows


def scale_of(name: str, unit: str, lever_arm: float | None) -> tuple[float, str]:
    """Return the factor from SI to the display unit, and that unit.

    With a lever arm in m, a deflection is in mm.
    """
    if name == DEFLECTION and lever_arm is not None:
        return 1e3 * lever_arm, "mm"
    fine = current().fine
    scales = {"N*m": (1.0, "N m"), "rad/s": (fine, "deg/s"), "rad": (fine, "deg")}
    each = {shown(si): (scale, shown(said)) for si, (scale, said) in scales.items()}
    return each.get(unit, (1.0, unit))


def draw_worst(case: WorstCase, run: WorstRun, spec: InteractionDesignSpec) -> Figure:
    """Draw a run: all quantities with limits and bounds, the command and the active controller."""
    lever_arm = common_lever_arm(spec, spec.touched)
    panels = [_panel(case, run, other.output, lever_arm) for other in case.runs]
    names = [channel.name for channel in case.system.channels]
    if _COMMAND in names:
        command = current().fine * run.disturbances[:, names.index(_COMMAND)]
        held = np.append(command, command[-1:])[:, None]
        panels.append(BoundedSignal(labelled("Command [deg/s]"), held, None, None))
    labels = [_controller(name) for name in _modes(case)]
    who = list(dict.fromkeys(labels))
    mode = np.array([who.index(labels[k]) for k in run.mode.tolist()], dtype=np.int64)
    return draw_bounded_run(SwitchedRun(run.time, run.states, mode), panels, who)


def response_of(case: WorstCase, run: WorstRun) -> TimeResponse:
    """Return a run as a table: quantities, states, disturbances, and the mode at every instant.

    Of a force with a range, the largest.
    """
    named = {other.output.name: other.output for other in case.runs}
    rows = [_largest(output_values(case.system, output, run.states)) for output in named.values()]
    signals = [
        Signal("torque" if name == "force" else name, output.unit) for name, output in named.items()
    ]
    held = np.concatenate([run.disturbances, run.disturbances[-1:]])
    mode = np.append(run.mode, run.mode[-1:])
    return TimeResponse(
        run.time,
        np.array(rows),
        run.states.T,
        held.T,
        tuple(signals),
        tuple(_signals(case.system.states)),
        tuple(Signal(channel.name, channel.unit) for channel in case.system.channels),
        mode,
        _modes(case),
    )


def _modes(case: WorstCase) -> tuple[str, ...]:
    free = () if case.system.contact is None else case.system.contact.free
    return tuple(mode.name for mode in (*case.system.modes, *free))


def _controller(mode: str) -> str:
    """Return the controller of a mode, and whether it touches anything."""
    parts = mode.split("/")
    return f"{parts[0]}, no contact" if "free" in parts[1:] else parts[0]


def _signals(states: tuple[str, ...]) -> Iterator[Signal]:
    for text in states:
        name, _, unit = text.partition(" [")
        yield Signal(f"state {name}", unit.removesuffix("]"))


def _largest(values: Array) -> Array:
    return np.asarray(values[np.arange(len(values)), np.abs(values).argmax(axis=1)])


def _panel(
    case: WorstCase, run: WorstRun, output: Output, lever_arm: float | None
) -> BoundedSignal:
    factor, unit = scale_of(output.name, output.unit, lever_arm)
    limit, bound = case.limits.get(output.name), case.bounds.get(output.name)
    return BoundedSignal(
        f"{output.name.capitalize()} [{unit}]",
        factor * output_values(case.system, output, run.states),
        None if limit is None else factor * limit,
        None if bound is None else np.full(len(run.time), factor * bound),
        one_sided=pushes_only(case.system, output),
    )
