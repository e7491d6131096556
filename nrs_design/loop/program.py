"""Program of a processor: the update of the state at a sample, and its roundings."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import takewhile

from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.step_analysis import rounding_share
from nrs_design.controllers.step_law import StepFrame, numbers_in_force, step_parts
from nrs_design.loop.calendar import Turn
from nrs_design.loop.sampled_law import (
    ERROR,
    IDLE_REFERENCE,
    IDLE_VELOCITY,
    KD,
    KEPT,
    KP,
    STEP,
    ListedLaw,
    kinds_of,
    list_law,
    second,
    short,
)
from nrs_design.loop.wires import Wires
from nrs_design.models.drive import Takes
from nrs_design.models.linear_form import ONE, ZERO, LinearForm

# States of a list of operations: the error of motion of a sample ago, and the reference of
# impedance controllers alone, of which the error of motion is kept.
BEFORE, REFERENCE = "error_before", "reference"
# What acts on a loop from outside, in this order; the last one is by how much a command is less
# than what the law makes of the sample, where a driver limits it.
INPUTS = (
    "velocity command",
    "friction",
    "encoder error",
    "force error",
    "rounding of the reference",
    "rounding of the angle",
    "cut off from the command",
)
HAND, FRICTION, ENCODER, FORCE_ERROR, ROUNDED_REFERENCE, ROUNDED_ANGLE, CUT_OFF = INPUTS


@dataclass(frozen=True, eq=False)
class SampledProgram:
    """The list of operations that ships, for all controllers of an axis."""

    step: StepFrame  # Motion controller and filter of the force
    laws: tuple[DiscreteLaw, ...]  # Laws of all controllers, with the exported coefficients
    # Factor of idle states per period; None if all laws are of one kind.
    idle: Fraction | None = None

    @cached_property
    def listed(self) -> ListedLaw:
        """The list of operations."""
        return list_law(self.step.order, kinds_of(self.laws), self.step.takes)

    @cached_property
    def counts(self) -> dict[str, int]:
        """Number of roundings of each term, in the order of certificates."""
        counts = self.listed.all_counts
        first = (ERROR, KP, KD, KEPT)
        last = (STEP, IDLE_REFERENCE, IDLE_VELOCITY, *self._placing)
        others = [name for name in counts if name not in (*first, *last)]
        return {name: counts[name] for name in (*first, *others, *last) if name in counts}

    @cached_property
    def roundings(self) -> dict[str, Fraction]:
        """Largest relative rounding error of each term."""
        shares = {name: short(rounding_share(count)) for name, count in self.counts.items()}
        return shares | {second(name): short(shares[KD] * shares[name]) for name in self._placing}

    @property
    def _placing(self) -> tuple[str, ...]:
        """The terms of a reference that is computed within a sample."""
        each = (results.get("error", {}) for results in self.listed.counts.values())
        return tuple(dict.fromkeys(name for terms in each for name in terms if name != ERROR))

    @cached_property
    def stored(self) -> dict[str, str]:
        """The states of the list by name: as modes call them."""
        return {value.name: value.stored for value in self.listed.law.states if value.stored}

    @cached_property
    def places(self) -> tuple[str, ...]:
        """The states that are a reference: those before the error of motion."""
        if BEFORE not in self.stored:
            return tuple(name for name in self.stored if name == REFERENCE)
        return tuple(takewhile(lambda name: name != BEFORE, self.stored))

    @property
    def lags(self) -> tuple[str, ...]:
        """The states of the filter of the force."""
        return tuple(text for name, text in self.stored.items() if name.startswith("filtered_"))

    def wire(self, w: Wires, law: DiscreteLaw, turn: Turn) -> dict[str, LinearForm]:
        """Set the results of a sample from ``measured`` and ``felt``.

        They are ``command``, and the next states, such as ``reference+``. Return a bound on each
        rounding.
        """
        given = {
            **{name: w[name] for name in self.stored},
            "angle": w["measured"],
            "torque": w["felt"],
            "velocity_command": w[HAND],
        }
        if law.law.commands == "position":
            # A position is rounded when read, the reference of an admittance when it moves.
            given["position"] = w[ROUNDED_REFERENCE]
        parts = step_parts(self.laws)
        numbers = self.step.numbers | numbers_in_force(law, parts, self.idle)
        rounded = {name: w[name] for name in self.roundings}
        step = self.listed.step(law, numbers, given, rounded, self.roundings)
        sizes: dict[str, LinearForm] = {}
        moving = law.law.commands == "velocity"
        for name, result in self.listed.following.items():
            if turn is (Turn.ADMITTANCE if name == BEFORE else Turn.MOTION):
                continue
            moved = ONE if moving and name in self.places else ZERO
            w.set({f"{name}+": w.sum((ONE, step.result(result)), (moved, w[ROUNDED_REFERENCE]))})
        if turn is not Turn.ADMITTANCE:
            streamed = ONE if self.step.takes is Takes.POSITION else ZERO
            w.set({"command": w.sum((ONE, step.command()), (streamed, w[ROUNDED_REFERENCE]))})
            sizes |= {} if self.step.streams else step.motion_sizes()
        return sizes if turn is Turn.MOTION else sizes | step.other_sizes()
