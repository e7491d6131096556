"""Disturbances and rounding errors that act on the modes of a sampled loop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.step_analysis import rounding_share
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm
from nrs_design.proof.channels import Channel, Rounding
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.spec.operating import Bounds
from nrs_design.switched.sampled_frame import INPUTS, Frame


@dataclass(frozen=True, slots=True)
class SampledMode:
    """One mode: what moves its states and bounds its roundings, and its command.

    Of two periods, it says whether it is in force where a round begins.
    """

    mode: Mode
    moves: tuple[LinearForm, ...]
    sizes: tuple[LinearForm, ...]
    command: LinearForm  # Before it is cut off
    point: str  # What it is a corner of, with others: of them all, one map is attained
    begins: bool = True

    @classmethod
    def of(
        cls, name: str, rows: Sequence[LinearForm], n: int, point: str, *, begins: bool = True
    ) -> SampledMode:
        """Take apart the rows that `Frame.rows` gives, of n states."""
        *rows, command = rows
        mode = Mode(name, RationalMatrix.from_rows([row[:n] for row in rows[:n]]))
        return cls(mode, tuple(rows[:n]), tuple(rows[n:]), command, point, begins)

    def column(self, i: int) -> RationalMatrix:
        """Return what the i-th of inputs and, after them, roundings does to the states."""
        return RationalMatrix.from_rows([[row[len(self.moves) + i]] for row in self.moves])


def channels_of(
    disturbances: Bounds | None,
    largest_angle: Fraction | None,
    off: Fraction,
    motions: Sequence[SampledMode],
) -> Iterator[Channel]:
    """Yield the disturbances of the spec, and the errors of its sensor, with their columns.

    `largest_angle`, in rad, is of what the law holds as single-precision numbers; `off`, in N m, is
    how far the force signal may be off for long. Motions of free motion are the last ones.
    """
    if disturbances is None:
        return
    bounds = dict(disturbances)
    if largest_angle is not None:
        # An angle of the law is read from a count, times a coefficient.
        for name, n in (("rounding of the reference", 1), ("rounding of the angle", 3)):
            bounds[name] = (rounding_share(n) * largest_angle, "rad")
    if off:
        bounds["force error"] = (off, "N*m")
    for i, name in enumerate(INPUTS):
        if name in bounds:
            bound, unit = bounds[name]
            yield Channel(name, unit, bound, tuple(motion.column(i) for motion in motions))


def roundings_of(
    frame: Frame, channels: Sequence[Channel], motions: Sequence[SampledMode]
) -> Iterator[Rounding]:
    """Yield what the arithmetic adds, with rows over the states and the declared disturbances."""
    kept = known_entries(frame, channels)
    for j, name in enumerate(frame.roundings):
        rows = _rows_over(kept, (motion.sizes[j] for motion in motions))
        columns = (motion.column(len(INPUTS) + j) for motion in motions)
        yield Rounding(name, tuple(columns), tuple(rows))


def _rows_over(kept: Sequence[int], forms: Iterable[LinearForm]) -> Iterator[RationalMatrix]:
    """Yield some entries of forms as rows; where corners share a form, it is one row."""
    made: dict[int, RationalMatrix] = {}
    for form in forms:
        if id(form) not in made:
            made[id(form)] = RationalMatrix.from_rows([[form[i] for i in kept]])
        yield made[id(form)]


def known_entries(frame: Frame, channels: Sequence[Channel]) -> list[int]:
    """Return where the states and the declared disturbances are in a form of a frame."""
    n, named = len(frame.states), [channel.name for channel in channels]
    return [*range(n), *(n + i for i, name in enumerate(INPUTS) if name in named)]


def anything_of(environments: Iterable[Environment], *, lost: bool) -> dict[str, Interval]:
    """Return where stiffness and damping are of any of some environments, or of nothing.

    `lost`: nothing may be touched, too. What is constant stays so where nothing else is touched.
    """
    each = [(e.stiffness, damping_of(e)) for e in environments]
    zero = Fraction(0)
    return {
        symbol: Interval(
            ranges[0].nominal,
            zero if lost else min(r.low for r in ranges),
            max(r.high for r in ranges),
            lost or len(ranges) > 1 or ranges[0].varies,
        )
        for symbol, ranges in zip(("k", "b"), zip(*each, strict=True), strict=True)
    }


def damping_of(environment: Environment) -> Interval:
    """Return the range of the damping beside the spring; zero for a spring."""
    return environment.parameters.get("b", Interval.point(Fraction(0)))
