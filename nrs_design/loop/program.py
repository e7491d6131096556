"""Program of a processor: the update of the state at a sample, and its roundings.

They follow from the list of operations that ships. The types of laws in a loop say the terms of
each result, and how often each is rounded; the numbers of the law in force say their sizes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import takewhile
from math import ceil
from typing import Any

from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.sensor import DiscreteLowPass
from nrs_design.controllers.step_analysis import (
    Term,
    counted_terms,
    rounded_terms,
    rounding_share,
)
from nrs_design.controllers.step_law import StepFrame, build_law, numbers_in_force, step_parts
from nrs_design.errors import InternalError
from nrs_design.loop.calendar import Turn
from nrs_design.loop.wires import Wires
from nrs_design.models.drive import CommandInterface
from nrs_design.models.linear_form import ONE, ZERO, LinearForm, combine, coordinates, zero

# Inputs that are not zero in the loop of a proof.
SENSED = frozenset({"angle", "torque", "velocity_command"})
# Coefficient other than zero and one, whose products need no rounding.
ANY = Fraction(1, 2)
# Terms of the list.
ERROR, KP, KD, DECAY, STEP = "e", "Kp e", "D (e - e before)", "a vm", "T (v - vm)"
IDLE_REFERENCE, IDLE_VELOCITY = "d r", "d vm"
# Terms with a rounded operand; `RoundedStep` bounds their second-order errors.
SECOND_ORDER = frozenset({KP, KD, STEP})


# The types of the laws of a loop, and the names of the numbers that those of a type have.
Kinds = tuple[tuple[type[Any], tuple[str, ...]], ...]


def kinds_of(laws: Iterable[DiscreteLaw]) -> Kinds:
    """Return the types of laws in the order of certificates: by command, then by few numbers."""
    found: dict[type[Any], dict[str, None]] = {}
    for law in laws:
        found.setdefault(law.law, {}).update(dict.fromkeys(law.numbers))
    order = sorted(found.items(), key=lambda item: (item[0].commands != "velocity", len(item[1])))
    return tuple((law, tuple(names)) for law, names in order)


@dataclass(frozen=True, slots=True)
class ListedLaw:
    """The list of operations of some types of laws; `list_law` makes each once."""

    __eq__, __hash__ = object.__eq__, object.__hash__

    # With any numbers; its modes are the types.
    law: StepLaw
    # For each mode and result: names of the terms in the list, and their unique names.
    names: Mapping[str, Mapping[str, Mapping[str, str]]]
    # For each mode and result: number of roundings of each term, by unique name.
    counts: Mapping[str, Mapping[str, Mapping[str, int]]]

    @property
    def following(self) -> dict[str, str]:
        """The states of the loop, and the results that they have after a sample."""
        return {v.name: self.law.following[v.name] for v in self.law.states if v.stored}

    @property
    def all_counts(self) -> dict[str, int]:
        """Largest number of roundings of each term, in the order of the list."""
        largest: dict[str, int] = {}
        for mode in self.counts.values():
            for name, count in ((n, c) for terms in mode.values() for n, c in terms.items()):
                largest[name] = max(count, largest.get(name, 0))
        return largest

    def step(
        self,
        law: DiscreteLaw,
        numbers: Mapping[str, Fraction],
        inputs: Mapping[str, LinearForm],
        roundings: Mapping[str, LinearForm],
        shares: Mapping[str, Fraction],
    ) -> RoundedStep:
        """Return a sample of a law in force; inputs and states that are missing are zero."""
        mode = law.law.name
        nothing = zero(len(next(iter(inputs.values()))))
        values = {value.name: inputs.get(value.name, nothing) for value in self.law.values}
        off = {
            result: _sum(nothing, (roundings[name] for name in terms))
            for result, terms in self.counts[mode].items()
        }
        errors = {name: off[name] for name in own_results(self.law)}
        found = rounded_terms(self.law, self.law.modes.index(mode), values, numbers, errors)
        terms = {
            result: tuple(replace(t, name=names.get(t.name, t.name)) for t in found[result])
            for result, names in self.names[mode].items()
        }
        return RoundedStep(self.law, numbers, roundings, shares, terms, off)


@lru_cache(maxsize=32)
def list_law(order: int, kinds: Kinds, interface: CommandInterface | None = None) -> ListedLaw:
    """Write the list out, and count its roundings.

    `order` is the order of the force filter; `interface` is the command of a robot that controls
    its own motor. An `InternalError` if a term takes a rounded number, and the addition has no
    bound.
    """
    laws = {law.name: DiscreteLaw(law, dict.fromkeys(names, ANY)) for law, names in kinds}
    low_pass = DiscreteLowPass(order, ANY, ANY) if order else None
    law = build_law(StepFrame(ANY, ANY, low_pass, interface=interface), laws, ANY)
    *unit, mark = coordinates(len(law.values) + 1)
    # Commands are zero in the loop of a proof; angles count from the commanded angle.
    inputs: dict[str, LinearForm] = {
        value.name: form if value.stored or value.name in SENSED else zero(len(mark))
        for value, form in zip(law.values, unit, strict=True)
    }
    left_out = {law.following[value.name] for value in law.states if not value.stored}
    all_names: dict[str, dict[str, dict[str, str]]] = {}
    counts: dict[str, dict[str, dict[str, int]]] = {}
    takes_rounded: set[str] = set()
    for i, mode in enumerate(law.modes):
        names, tally = all_names.setdefault(mode, {}), counts.setdefault(mode, {})
        term_names: set[str] = set()
        for result, terms in counted_terms(law, i, inputs).items():
            if result in left_out:
                continue
            # Roundings of different results are independent, so names are unique.
            names[result] = {t: f"{t} kept" if t in term_names else t for t in terms}
            tally[result] = {names[result][term]: count for term, count in terms.items()}
            term_names |= {*tally[result]}
        marked = rounded_terms(law, i, inputs, errors=dict.fromkeys(own_results(law), mark))
        takes_rounded |= {t.name for terms in marked.values() for t in terms if t.form[-1]}
    if unknown := takes_rounded - SECOND_ORDER:
        raise InternalError(f"the second order of {', '.join(sorted(unknown))} is not bounded")
    return ListedLaw(law, all_names, counts)


def own_results(law: StepLaw) -> Iterator[str]:
    """Yield the results whose rounding is counted apart from that of their terms."""
    yield from (operation.name for operation in law.operations if operation.rounding == "own")


def _sum(first: LinearForm, forms: Iterable[LinearForm]) -> LinearForm:
    return combine((ONE, first), *((ONE, form) for form in forms))


# Binary digits of how large roundings are.
SIZE_BITS = 8


def short(size: Fraction) -> Fraction:
    """Round away from zero to a few binary digits, so that the numbers of proofs stay short."""
    bits = size.numerator.bit_length() - size.denominator.bit_length()
    unit = Fraction(2) ** (bits - SIZE_BITS)
    return ceil(abs(size) / unit) * unit * (1 if size >= 0 else -1)


def second(name: str) -> str:
    """Name the second-order rounding error that a term of the reference adds to the command."""
    return f"u of {name}"


@dataclass(frozen=True, slots=True)
class RoundedStep:
    """One sample of a law in force."""

    law: StepLaw  # The list of operations
    numbers: Mapping[str, Fraction]  # Its coefficients by name
    # Rounding error of each term: the last coordinates of all forms.
    roundings: Mapping[str, LinearForm]
    shares: Mapping[str, Fraction]  # Bounds on these errors, relative to the terms
    terms: Mapping[str, tuple[Term, ...]]  # Terms of each result
    off: Mapping[str, LinearForm]  # Rounding error of each result

    def result(self, name: str) -> LinearForm:
        """Return a result with its rounding error."""
        return _sum(self.off[name], (term.form for term in self.terms[name]))

    def command(self) -> LinearForm:
        """Return the command with its rounding errors, those of second order apart."""
        names = (second(term.name) for term in self.terms.get("error", ()))
        off = (self.roundings[name] for name in names if name in self.roundings)
        return _sum(self.result(self.law.outputs["command"]), off)

    def motion_sizes(self) -> dict[str, LinearForm]:
        """Return bounds on the roundings of error and command, by their terms."""
        shares, Kp, D = self.shares, self.numbers["Kp"], self.numbers["Kd_over_T"]
        summands = {term.name: self._exact(term.form) for term in self.terms["error"]}
        read = combine(*((ONE, form) for form in summands.values()))
        parts = {term.name: self._exact(term.form) for term in self.terms[self._command]}
        # The second-order part of a sum of two sizes counts with another term. Without damping,
        # the command has one term.
        off = shares.get(KD, Fraction(0))
        share = shares[KP] * Kp * (1 + shares[ERROR]) + off * D * shares[ERROR]
        sizes: dict[str, LinearForm] = {
            ERROR: combine((shares[ERROR], read)),
            KP: combine((short(share), read)),
        }
        for name, form in parts.items():
            if name == KD:
                sizes[KD] = _shorten(shares[KD], D, form)
            elif name != KP and name in shares:
                sizes[name] = combine((shares[name], form))
        for name in summands.keys() & shares.keys() - {ERROR}:
            sizes[name] = combine((shares[name], summands[name]))
            sizes[second(name)] = combine((shares[second(name)] * (Kp + D), summands[name]))
        return sizes

    def result_sizes(self) -> dict[str, LinearForm]:
        """Return bounds on the roundings of all other results."""
        sizes: dict[str, LinearForm] = {}
        factors = {STEP: "T", DECAY: "a"}
        separate = {*own_results(self.law)}
        for result in self.terms.keys() - {"error", self._command}:
            growth = 1 + self.shares[STEP] if result in separate else ONE
            for term in self.terms[result]:
                if (share := self.shares.get(term.name)) is None:
                    continue
                form = self._exact(term.form)
                if term.name in factors:
                    factor = self.numbers[factors[term.name]]
                    sizes[term.name] = _shorten(share, factor, form)
                else:
                    # The second-order part of a sum of two sizes counts with another term.
                    sizes[term.name] = combine((share * growth, form))
        return sizes

    @property
    def _command(self) -> str:
        """Name of the result that the command is, of a motion controller."""
        command = self.law.outputs["command"]
        return command if "error" in self.terms else "command"

    def _exact(self, form: LinearForm) -> LinearForm:
        """Return what a form is without roundings."""
        end = len(form) - len(self.roundings)
        return [*form[:end], *(Fraction(0) for _ in form[end:])]


def _shorten(share: Fraction, factor: Fraction, form: LinearForm) -> LinearForm:
    """Return a share of what is a factor times another form, in short numbers."""
    return combine((short(share * factor) / factor if factor else ONE, form))


# States of a list of operations: the error of motion of a sample ago, and the reference of
# impedance controllers alone, of which the error of motion is kept.
LAST_ERROR, REFERENCE = "error_before", "reference"
# Inputs of a loop, in this order; the last one is the part of a command that a driver cuts off.
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
    # Decay factor of idle states per period; None without a rule for idle states.
    idle: Fraction | None = None

    @cached_property
    def operation_list(self) -> ListedLaw:
        """The list of operations."""
        return list_law(self.step.order, kinds_of(self.laws), self.step.interface)

    @cached_property
    def counts(self) -> dict[str, int]:
        """Number of roundings of each term, in the order of certificates."""
        counts = self.operation_list.all_counts
        first = (ERROR, KP, KD, DECAY)
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
        errors = (results.get("error", {}) for results in self.operation_list.counts.values())
        return tuple(dict.fromkeys(name for terms in errors for name in terms if name != ERROR))

    @cached_property
    def stored(self) -> dict[str, str]:
        """The states of the list by name: as modes call them."""
        return {
            value.name: value.stored for value in self.operation_list.law.states if value.stored
        }

    @cached_property
    def places(self) -> tuple[str, ...]:
        """The states that are a reference: those before the error of motion."""
        if LAST_ERROR not in self.stored:
            return tuple(name for name in self.stored if name == REFERENCE)
        return tuple(takewhile(lambda name: name != LAST_ERROR, self.stored))

    @property
    def lags(self) -> tuple[str, ...]:
        """The states of the filter of the force."""
        return tuple(text for name, text in self.stored.items() if name.startswith("filtered_"))

    def wire(self, w: Wires, law: DiscreteLaw, turn: Turn) -> dict[str, LinearForm]:
        """Set the results of a sample from ``measured`` and ``felt``.

        They are ``command`` and next states, such as ``reference+``. Return bounds on roundings.
        """
        inputs = {
            **{name: w[name] for name in self.stored},
            "angle": w["measured"],
            "torque": w["felt"],
            "velocity_command": w[HAND],
        }
        if law.law.commands == "position":
            # A position is rounded when read, the reference of an admittance when it moves.
            inputs["position"] = w[ROUNDED_REFERENCE]
        parts = step_parts(self.laws)
        numbers = self.step.numbers | numbers_in_force(law, parts, self.idle)
        roundings = {name: w[name] for name in self.roundings}
        step = self.operation_list.step(law, numbers, inputs, roundings, self.roundings)
        sizes: dict[str, LinearForm] = {}
        moving = law.law.commands == "velocity"
        for name, result in self.operation_list.following.items():
            if turn is (Turn.ADMITTANCE if name == LAST_ERROR else Turn.MOTION):
                continue
            share = ONE if moving and name in self.places else ZERO
            w.set({f"{name}+": w.sum((ONE, step.result(result)), (share, w[ROUNDED_REFERENCE]))})
        if turn is not Turn.ADMITTANCE:
            streamed = ONE if self.step.interface is CommandInterface.POSITION else ZERO
            w.set({"command": w.sum((ONE, step.command()), (streamed, w[ROUNDED_REFERENCE]))})
            sizes |= {} if self.step.streams else step.motion_sizes()
        return sizes if turn is Turn.MOTION else sizes | step.result_sizes()
