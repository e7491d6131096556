"""The modes of a loop whose samples and commands come at any time in an interval.

Let a sample be followed by the next one after h, and by the command u that is computed of it after
d <= h, while the one before, u', is held. Then the plant x' = A x + B u is at the next sample at

    x+ = exp(A h) (x - int_0^d exp(-A s) ds B (u - u')) + int_0^h exp(A s) ds B u

So a period is two stays in turn: in mode ``delay``, for d, x moves by the first integral, and in
mode ``period``, for h, by A x + B u. Both are exponentials, and d and h do not depend on each
other: intervals of these times are intervals of stays. Where a command comes whole periods later,
it waits for so many samples as a state of the controller.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.proof.matrix import RationalMatrix, identity, multiply
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Reset, Stay, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.switched.assumptions import assume_timing

if TYPE_CHECKING:
    from nrs_design.spec.sampled_system import SampledSystemSpec

DELAY, PERIOD = "delay", "period"
# A mode follows another one: where no command is late, periods take turns.
TURNS = (f"{PERIOD}/1", f"{PERIOD}/2")
# Of the plant, of what a late command leaves out, of the controller, commands that wait, the newest
# first, and the one that is held.
PLANT, LATE, CONTROLLER, WAITING, COMMAND = "x", "late", "z", "waiting", "u"

Rows = Sequence[Sequence[Fraction]]


def close_timed_loop(spec: SampledSystemSpec) -> SwitchedSystem:
    """Return the switched system of a `sampled-system` spec.

    Parameters
    ----------
    spec : SampledSystemSpec
        Plant, controller, and the intervals of period and delay.
    """
    n = spec.plant.states
    late = spec.sampling.rests[1] > 0
    sizes = {PLANT: n} | ({LATE: n} if late else {})
    m = spec.plant.inputs
    sizes |= {CONTROLLER: spec.controller.states, WAITING: spec.sampling.waiting * m, COMMAND: m}
    A, B = spec.plant.A, spec.plant.B
    first = second = _blocks(sizes, {(PLANT, PLANT): A, (PLANT, COMMAND): B})
    to_first = to_second = _sample(spec, sizes)
    stays = [Stay(*spec.sampling.periods)] * 2
    if late:
        less = {(PLANT, LATE): _negative(_unit(n)), (LATE, LATE): _negative(A)}
        first = _blocks(sizes, less)
        kept = (PLANT, CONTROLLER, WAITING, COMMAND)
        to_second = _blocks(sizes, {(name, name): _unit(sizes[name]) for name in kept})
        stays[0] = Stay(*spec.sampling.rests)
    one, two = (DELAY, PERIOD) if late else TURNS
    return SwitchedSystem(
        name=spec.name,
        time=Time.CONTINUOUS,
        states=tuple(f"{name}{i + 1}" for name, size in sizes.items() for i in range(size)),
        modes=(Mode(one, first), Mode(two, second)),
        assumptions=assume_timing(spec),
        switching=Switching(
            resets=(Reset(one, two, to_second), Reset(two, one, to_first)),
            stays=tuple(zip((one, two), stays, strict=True)),
        ),
    )


def _sample(spec: SampledSystemSpec, sizes: Mapping[str, int]) -> RationalMatrix:
    """Return what a sample does: the controller moves on, and its command is the new one."""
    plant, controller = spec.plant, spec.controller
    C = _unit(plant.states) if plant.C is None else plant.C
    blocks: dict[tuple[str, str], Rows] = {(PLANT, PLANT): _unit(plant.states)}
    if (gain := controller.K or controller.D) is not None:
        blocks[COMMAND, PLANT] = multiply(gain, C)
    if controller.A is not None and controller.B is not None and controller.C is not None:
        blocks[CONTROLLER, CONTROLLER] = controller.A
        blocks[CONTROLLER, PLANT] = multiply(controller.B, C)
        blocks[COMMAND, CONTROLLER] = controller.C
    sources: tuple[str, ...] = (PLANT, CONTROLLER)
    if waiting := sizes[WAITING]:
        # Each waits one sample longer; the oldest one takes effect.
        blocks |= {
            (WAITING, name): blocks.pop((COMMAND, name))
            for name in sources
            if (COMMAND, name) in blocks
        }
        m, unit, sources = plant.inputs, _unit(waiting), (WAITING,)
        blocks[WAITING, WAITING] = [[Fraction(0)] * waiting] * m + [*unit[:-m]]
        blocks[COMMAND, WAITING] = unit[-m:]
    if LATE in sizes:
        blocks |= {
            (LATE, name): multiply(plant.B, blocks[COMMAND, name])
            for name in sources
            if (COMMAND, name) in blocks
        }
        blocks[LATE, COMMAND] = _negative(plant.B)
    return _blocks(sizes, blocks)


def _blocks(sizes: Mapping[str, int], blocks: Mapping[tuple[str, str], Rows]) -> RationalMatrix:
    """Return a matrix by its blocks, each by the states after and before; the others are zero."""
    first, order = dict[str, int](), 0
    for name, size in sizes.items():
        first[name], order = order, order + size
    rows = [[Fraction(0)] * order for _ in range(order)]
    for (after, before), block in blocks.items():
        for i, row in enumerate(block):
            for j, entry in enumerate(row):
                rows[first[after] + i][first[before] + j] = entry
    return RationalMatrix.from_rows(rows)


def _unit(size: int) -> Rows:
    return identity(size).fractions()


def _negative(matrix: Rows) -> Rows:
    return [[-entry for entry in row] for row in matrix]
