"""The spec of a sampled loop of given matrices: plant, controller, and when they meet."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from nrs_design.proof.text import exact_text
from nrs_design.spec.certification import CertificationSpec
from nrs_design.spec.check import Row, each
from nrs_design.spec.faults import Location
from nrs_design.spec.fields import Exact, Name, Title
from nrs_design.spec.model import SpecModel, optional
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.quantity_fields import TimeRange, Times, ends_of
from nrs_design.spec.switching import LONGEST_DWELL, MAX_DIMENSION, matrix_checks

_Row = Annotated[tuple[Exact, ...], Field(min_length=1, max_length=MAX_DIMENSION)]
_Matrix = Annotated[tuple[_Row, ...], Field(min_length=1, max_length=MAX_DIMENSION)]
Shape = tuple[int, int]


def _shape(matrix: _Matrix) -> Shape:
    return len(matrix), len(matrix[0])


def _checks_of(keys: str) -> tuple[Row[Any], ...]:
    """Return the checks of each of these matrices, as far as they are there."""

    def checks(key: str) -> tuple[Row[Any], ...]:
        return matrix_checks(
            key,
            lambda s: getattr(s, key) or ((),),
            lambda s: (entry for row in getattr(s, key) or () for entry in row),
        )

    return tuple(check for key in keys for check in checks(key))


def _shapes(part: SpecModel, keys: str) -> dict[str, Shape]:
    found = {key: getattr(part, key) for key in keys}
    return {key: _shape(matrix) for key, matrix in found.items() if matrix is not None}


class HeldPlantSpec(SpecModel):
    """The plant ``x' = A x + B u``, ``y = C x``, in continuous time; u is held between changes."""

    A: _Matrix = Field(description="n x n, in 1/s; exact numbers")
    B: _Matrix = Field(description="n x m: what the command u does")
    C: _Matrix | None = optional("what is measured at a sample; default: the state")

    @property
    def states(self) -> int:
        """How many states it has."""
        return len(self.A)

    @property
    def shapes(self) -> dict[str, Shape]:
        """Rows and columns of the matrices that are there."""
        return _shapes(self, "ABC")

    @property
    def inputs(self) -> int:
        """How many commands it takes."""
        return len(self.B[0])

    @property
    def outputs(self) -> int:
        """How many numbers are measured."""
        return self.states if self.C is None else len(self.C)

    checks = (
        *_checks_of("ABC"),
        Row(
            "A",
            lambda s: len(set(_shape(s.A))) > 1 and _shape(s.A),
            "the matrix is {0} x {1}, not square",
            "write as many rows as columns",
        ),
        Row(
            "B",
            lambda s: len(s.B) != len(s.A) and (len(s.B), len(s.A)),
            "the matrix has {0} rows, and the plant has {1} states",
            "write a row for each state",
        ),
        Row(
            "C",
            lambda s: s.C is not None and len(s.C[0]) != len(s.A) and (len(s.C[0]), len(s.A)),
            "the matrix has {0} columns, and the plant has {1} states",
            "write a column for each state",
        ),
    )


class SampledControllerSpec(SpecModel):
    """What computes the command: ``u = K y``, or ``z+ = A z + B y`` and ``u = C z + D y``."""

    K: _Matrix | None = optional("m x outputs: a gain, u = K y")
    A: _Matrix | None = optional("in the place of K, with B and C: p x p, of the states z")
    B: _Matrix | None = optional("p x outputs: what a sample does to z")
    C: _Matrix | None = optional("m x p: what z adds to the command")
    D: _Matrix | None = optional("m x outputs: what the sample adds at once; default: nothing")

    @property
    def states(self) -> int:
        """How many states it has."""
        return 0 if self.A is None else len(self.A)

    @property
    def shapes(self) -> dict[str, Shape]:
        """Rows and columns of the matrices that are there."""
        return _shapes(self, "KABCD")

    checks = (
        *_checks_of("KABCD"),
        Row(
            "",
            lambda s: s.shapes.keys() not in ({"K"}, {"A", "B", "C"}, {"A", "B", "C", "D"}),
            "a controller is a gain, or has states",
            "write K alone, or A, B and C, and D if the sample acts at once",
        ),
    )


def _up_to(times: Times, longest: Fraction) -> Times:
    end = Quantity(f"{exact_text(longest)} s", longest, "s")
    return times._replace(shortest=min(times.shortest, end, key=lambda t: t.exact), longest=end)


def _in_words(times: Times) -> str:
    first, last = times.shortest.text, times.longest.text
    return first if first == last else f"{first} to {last}"


class TimingSpec(SpecModel):
    """When samples are taken, and when their commands take effect."""

    period: TimeRange = Field(
        description="time in s from a sample to the next: one number, or [shortest, longest] for "
        "one that may differ every time"
    )
    delay: TimeRange | None = optional(
        "time in s from a sample to where its command takes effect: one number, or [shortest, "
        "longest] for one that may differ every time; at most the shortest period, or between two "
        "whole numbers of a constant one; default: at once"
    )

    @property
    def periods(self) -> tuple[Fraction, Fraction]:
        """The shortest and the longest time between samples, in s."""
        return ends_of(self.period)

    @property
    def delays(self) -> tuple[Fraction, Fraction]:
        """The shortest and the longest time to the command, in s."""
        return ends_of(self.delay)

    def __str__(self) -> str:
        """Say period and delay in a few words."""
        return ", ".join(f"{key} {_in_words(times)}" for (key,), times in self._written())

    @property
    def waiting(self) -> int:
        """How many whole periods every command waits, where periods are constant."""
        first, last = self.periods
        return int(self.delays[0] // first) if first == last and first > 0 else 0

    @property
    def rests(self) -> tuple[Fraction, Fraction]:
        """The shortest and the longest delay without the whole periods, in s."""
        whole = self.waiting * self.periods[0]
        return self.delays[0] - whole, self.delays[1] - whole

    def with_longest(self, period: Fraction, delay: Fraction) -> TimingSpec:
        """Return other longest times, with the same shortest ones unless these are longer."""
        changed = {"period": _up_to(self.period, period)}
        if self.delay is not None:
            changed["delay"] = _up_to(self.delay, delay)
        return self.model_copy(update=changed)

    def _written(self) -> Iterator[tuple[Location, Times]]:
        for key in ("period", "delay"):
            if (times := getattr(self, key)) is not None:
                yield (key,), times

    checks = (
        Row(
            "period",
            lambda s: s.period.shortest.exact == 0,
            "a period of zero is no time between two samples",
            "write the shortest time that occurs; feedback without sampling is a switched-system "
            "with the matrix A + B K",
        ),
        Row(
            "period",
            lambda s: s.period.longest.exact > LONGEST_DWELL and s.period.longest.text,
            f"a period of {{0}} is longer than {LONGEST_DWELL} s",
            "write the matrices in another unit of time",
        ),
        Row(
            "delay",
            lambda s: (
                len(set(s.periods)) > 1
                and s.delays[1] > s.periods[0] > 0
                and (s.delay.longest.text, s.period.shortest.text)
            ),
            "a delay of {0} is longer than the shortest period, {1}, and is not modelled where "
            "periods vary",
            "write a delay of at most the shortest period, or a constant period",
        ),
        Row(
            "delay",
            lambda s: (
                len(set(s.periods)) == 1
                and s.rests[1] > s.periods[0] > 0
                and (s.delay.shortest.text, s.delay.longest.text, s.period.longest.text)
            ),
            "delays from {0} to {1} are not all between two whole numbers of periods of {2}",
            "write an interval that is, such as from 0 to 1 period or from 1 to 2",
        ),
        Row(
            "delay",
            lambda s: s.waiting > MAX_DIMENSION and (s.delay.longest.text, s.waiting),
            f"a delay of {{0}} is {{1}} whole periods, at most {MAX_DIMENSION} are read",
            "shorten it, or sample less often",
        ),
        *each(
            lambda s: s._written(),
            Row[Times](
                "varies",
                lambda times: times.is_constant,
                "a time that is unknown but constant is not modelled here",
                "write [shortest, longest], which also covers it",
            ),
        ),
    )


class SampledSystemSpec(SpecModel):
    """A plant in continuous time, and a controller that meets it at samples."""

    kind: Literal["sampled-system"] = Field(description="what this file describes")
    name: Name = Field(description="short name: lower-case letters, digits, '.', '_', '-'")
    title: Title = Field(default="", description="one line for people, at most 200 characters")
    plant: HeldPlantSpec = Field(description="x' = A x + B u, y = C x")
    controller: SampledControllerSpec = Field(
        description="a gain K, u = K y, or z+ = A z + B y and u = C z + D y"
    )
    sampling: TimingSpec = Field(
        description="period and delay, each a number or anywhere in an interval, at every sample"
    )
    certification: CertificationSpec = Field(
        default_factory=CertificationSpec.model_construct,
        description="how far the search for a proof goes",
    )

    # No matrix has a parameter: what is in an interval here are times.
    has_ranges: ClassVar[bool] = False

    @property
    def states(self) -> int:
        """How many states the loop has: those of the plant count twice where a command is late."""
        own = self.plant.states * (2 if self.sampling.rests[1] > 0 else 1)
        return own + self.controller.states + self.plant.inputs * (1 + self.sampling.waiting)

    def find_dwell_obstacle(self) -> None:
        """Return None: nothing in the matrices changes between two switches."""

    checks = (
        *each(
            lambda s: _misfits(s),
            Row[tuple[Shape, Shape, str]](
                "",
                lambda found: (*found[0], *found[1], found[2]),
                "the matrix is {0} x {1}, expected {2} x {3}: {4}",
                "write as many rows and columns",
            ),
        ),
        Row(
            "plant.A",
            lambda s: s.states > MAX_DIMENSION and s.states,
            f"the loop has {{0}} states, at most {MAX_DIMENSION} are read",
            "reduce the model",
        ),
    )


def _misfits(
    spec: SampledSystemSpec,
) -> Iterator[tuple[Location, tuple[Shape, Shape, str]]]:
    """Yield the matrices of the controller that do not fit the plant or each other."""
    plant, states = spec.plant, spec.controller.states
    m, measured = plant.inputs, plant.outputs
    said = f"{m} commands, {measured} measured numbers, {states} states of the controller"
    expected = {
        "K": (m, measured),
        "A": (states, states),
        "B": (states, measured),
        "C": (m, states),
        "D": (m, measured),
    }
    for key, shape in spec.controller.shapes.items():
        if shape != expected[key]:
            yield ("controller", key), (shape, expected[key], said)
