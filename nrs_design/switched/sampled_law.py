"""The law in a sampled loop, from the list of operations that ships.

What a result is a sum of, and how often each term is rounded, follows from the kinds of laws that
a loop has, whatever their numbers; what each term is, from the numbers of the law in force.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.sampled import (
    SampledAdmittance,
    SampledForce,
    SampledLaw,
    SampledMotion,
)
from nrs_design.controllers.sensor import SampledLowPass
from nrs_design.controllers.step_analysis import Term, counted_terms, rounded_terms
from nrs_design.controllers.step_law import build_law
from nrs_design.controllers.step_parts import StepFrame
from nrs_design.errors import InternalError
from nrs_design.models.linear_form import LinearForm, combine, coordinates, zero

ONE = Fraction(1)
# Not in the loop of a proof: what is commanded is zero, and angles count from there.
ABSENT = frozenset({"position", "wanted_torque", "commanded"})
# Any number that is neither zero nor one: a product with one of these is exact.
ANY = Fraction(1, 2)
# Terms of the list.
ERROR, KP, KD, KEPT, STEP = "e", "Kp e", "D (e - e before)", "a vm", "T (v - vm)"
IDLE_REFERENCE, IDLE_VELOCITY = "d r", "d vm"
INTEGRAL, KEPT_INTEGRAL = "w", "w kept"
# Those that take a rounded number, of which `nrs_design.switched.sampled_step` bounds what that
# adds to their own rounding.
SECOND_ORDER = frozenset({KP, KD, STEP})


@dataclass(frozen=True, slots=True)
class Kinds:
    """Which kinds of laws a loop has."""

    order: int  # Lags of the filter of the force
    # inert, sprung: whether admittances have a velocity of their own, and whether one has a spring.
    inert: bool
    sprung: bool
    # moves, places, takes_force, gathers: whether there are impedance controllers, others, and
    # proportional and PI force controllers among these.
    moves: bool
    places: bool
    takes_force: bool
    gathers: bool = False


@dataclass(frozen=True, slots=True)
class ListedLaw:
    """The list of operations of some kinds of laws; `list_law` makes each once."""

    __eq__, __hash__ = object.__eq__, object.__hash__

    law: StepLaw  # With any numbers; its modes are the kinds
    # For each mode and result, how often each of its terms is rounded, by name.
    counts: Mapping[str, Mapping[str, Mapping[str, int]]]

    @property
    def following(self) -> dict[str, str]:
        """The states of the loop, and the results that they have after a sample."""
        return {s: made for s, made in self.law.following.items() if s not in ABSENT}

    @property
    def all_counts(self) -> dict[str, int]:
        """How often each term is rounded at most, in the order of the list."""
        most: dict[str, int] = {}
        for mode in self.counts.values():
            for name, count in ((n, c) for terms in mode.values() for n, c in terms.items()):
                most[name] = max(count, most.get(name, 0))
        return most

    def terms(
        self,
        law: SampledLaw,
        numbers: Mapping[str, Fraction],
        given: Mapping[str, LinearForm],
        rounded: Mapping[str, LinearForm],
    ) -> dict[str, tuple[Term, ...]]:
        """Return what each result is a sum of.

        Parameters
        ----------
        law : SampledAdmittance or SampledForce
            In force.
        numbers : mapping of str to Fraction
            Its coefficients by name.
        given : mapping of str to LinearForm
            Inputs and states; those that are missing are zero.
        rounded : mapping of str to LinearForm
            By what terms are off, by name.
        """
        mode = mode_of(law)
        nothing = zero(len(next(iter(given.values()))))
        every = {value.name: given.get(value.name, nothing) for value in self.law.values}
        errors = {
            name: combine((ONE, nothing), *((ONE, form) for form in self.off(law, name, rounded)))
            for name in own_results(self.law)
        }
        found = rounded_terms(self.law, self.law.modes.index(mode), every, numbers, errors)
        return {
            name: tuple(replace(term, name=_name(term, mode, name)) for term in terms)
            for name, terms in found.items()
        }

    def off(
        self, law: SampledLaw, result: str, rounded: Mapping[str, LinearForm]
    ) -> list[LinearForm]:
        """Return by what the terms of a result are off.

        Parameters
        ----------
        law : SampledAdmittance or SampledForce
            In force.
        result : str
            Name of the result.
        rounded : mapping of str to LinearForm
            By what terms are off, by name.
        """
        return [rounded[name] for name in self.counts[mode_of(law)][result]]


def mode_of(law: SampledLaw) -> str:
    """Return the mode of the list in which a law is active."""
    if isinstance(law, SampledAdmittance):
        return "impedance"
    if law.Ki_T:
        return "pi-force"
    return "force" if law.Kp else "position"


@lru_cache(maxsize=32)
def list_law(kinds: Kinds) -> ListedLaw:
    """Write the list out, and count its roundings.

    Raises
    ------
    InternalError
        If a term takes a rounded number and nothing bounds what that adds to its own rounding.
    """
    laws: dict[str, SampledLaw] = {}
    if kinds.moves:
        a, Kt = ANY if kinds.inert else None, ANY if kinds.sprung else Fraction(0)
        laws["impedance"] = SampledAdmittance(a, ANY, ANY, Kt)
    if kinds.places:
        laws["position"] = SampledForce(Fraction(0))
        laws |= {"force": SampledForce(ANY)} if kinds.takes_force else {}
        laws |= {"pi-force": SampledForce(ANY, ANY)} if kinds.gathers else {}
    low_pass = SampledLowPass(kinds.order, ANY, ANY) if kinds.order else None
    law = build_law(StepFrame(SampledMotion(ANY, ANY), low_pass), laws, ANY)
    *unit, mark = coordinates(len(law.values) + 1)
    given: dict[str, LinearForm] = {
        value.name: zero(len(mark)) if value.name in ABSENT else form
        for value, form in zip(law.values, unit, strict=True)
    }
    left_out = {law.following[name] for name in ABSENT & law.following.keys()}
    counts: dict[str, dict[str, dict[str, int]]] = {}
    takes_rounded: set[str] = set()
    for i, mode in enumerate(law.modes):
        each = counted_terms(law, i, given)
        counts[mode] = {
            result: {_renamed(term, mode, result): count for term, count in terms.items()}
            for result, terms in each.items()
            if result not in left_out
        }
        names = [name for terms in counts[mode].values() for name in terms]
        if len({*names}) < len(names):
            # One name is one rounding: of two results, each has its own.
            raise InternalError(f"a term of {mode} is rounded in two results")
        marked = rounded_terms(law, i, given, errors=dict.fromkeys(own_results(law), mark))
        takes_rounded |= {t.name for terms in marked.values() for t in terms if t.form[-1]}
    if unknown := takes_rounded - SECOND_ORDER:
        raise InternalError(f"the second order of {', '.join(sorted(unknown))} is not bounded")
    return ListedLaw(law, counts)


def own_results(law: StepLaw) -> Iterator[str]:
    """Yield the results with a rounding of their own."""
    yield from (operation.name for operation in law.operations if operation.rounding == "own")


def _name(term: Term, mode: str, result: str) -> str:
    return _renamed(term.name, mode, result)


def _renamed(term: str, mode: str, result: str) -> str:
    """Name a term: the coefficient of a velocity that is idle is d.

    The integral is rounded once in the reference and once as it goes on, each by itself.
    """
    if term == INTEGRAL and result == "next_integral":
        return KEPT_INTEGRAL
    return IDLE_VELOCITY if term == KEPT and mode != "impedance" else term
