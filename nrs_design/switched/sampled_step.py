"""What the law of a sampled loop makes of a sample, and how large its roundings are at most."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.step_analysis import Term
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.switched.sampled_law import (
    ERROR,
    KD,
    KEPT,
    KP,
    ONE,
    STEP,
    ListedLaw,
    own_results,
)

# Binary digits of how large roundings are.
SIZE_BITS = 8


def short(size: Fraction) -> Fraction:
    """Round away from zero to a few binary digits, so that the numbers of proofs stay short."""
    bits = size.numerator.bit_length() - size.denominator.bit_length()
    unit = Fraction(2) ** (bits - SIZE_BITS)
    return ceil(abs(size) / unit) * unit * (1 if size >= 0 else -1)


def second(name: str) -> str:
    """Name the part of second order of what a term of the reference does to the command."""
    return f"u of {name}"


@dataclass(frozen=True, slots=True)
class RoundedStep:
    """One sample of a law in force."""

    listed: ListedLaw  # The list of operations
    law: DiscreteLaw  # In force
    numbers: Mapping[str, Fraction]  # Its coefficients by name
    # By what each term is off, the last coordinates of all forms.
    rounded: Mapping[str, LinearForm]
    shares: Mapping[str, Fraction]  # How far that is at most, over the size of the term
    terms: Mapping[str, tuple[Term, ...]]  # What each result is a sum of

    def result(self, name: str, nothing: LinearForm) -> LinearForm:
        """Return a result with what it is rounded by."""
        forms = [term.form for term in self.terms[name]]
        off = self.listed.off(self.law, name, self.rounded)
        return combine((ONE, nothing), *((ONE, form) for form in (*forms, *off)))

    def command(self, nothing: LinearForm) -> LinearForm:
        """Return the command with what it is rounded by, that of second order apart."""
        again = (second(term.name) for term in self.terms["error"])
        off = (self.rounded[name] for name in again if name in self.rounded)
        return combine((ONE, self.result("command", nothing)), *((ONE, form) for form in off))

    def motion_sizes(self) -> dict[str, LinearForm]:
        """Return what bounds the roundings of error and command, by their terms."""
        shares, Kp, D = self.shares, self.numbers["Kp"], self.numbers["Kd_over_T"]
        summands = {term.name: self._exact(term.form) for term in self.terms["error"]}
        read = combine(*((ONE, form) for form in summands.values()))
        (change,) = (self._exact(t.form) for t in self.terms["command"] if t.name == KD)
        # Of a sum of two sizes, the part that is of second order counts with another term.
        more = shares[KP] * Kp * (1 + shares[ERROR]) + shares[KD] * D * shares[ERROR]
        sizes: dict[str, LinearForm] = {
            ERROR: combine((shares[ERROR], read)),
            KP: combine((short(more), read)),
            KD: _shortened(shares[KD], D, change),
        }
        for name in summands.keys() & shares.keys() - {ERROR}:
            sizes[name] = combine((shares[name], summands[name]))
            sizes[second(name)] = combine((shares[second(name)] * (Kp + D), summands[name]))
        return sizes

    def other_sizes(self, *, retuned: bool) -> dict[str, LinearForm]:
        """Return what bounds the roundings of all other results.

        Parameters
        ----------
        retuned : bool
            Whether the coefficient of the velocity has a range: its corners suffice for what is
            affine in it.
        """
        sizes: dict[str, LinearForm] = {}
        factors = {STEP: "T"} if retuned else {STEP: "T", KEPT: "a"}
        own = {*own_results(self.listed.law)}
        for result in self.terms.keys() - {"error", "command"}:
            beyond = 1 + self.shares[STEP] if result in own else ONE
            for term in self.terms[result]:
                if (share := self.shares.get(term.name)) is None:
                    continue
                form = self._exact(term.form)
                if term.name in factors:
                    factor = self.numbers[factors[term.name]]
                    sizes[term.name] = _shortened(share, factor, form)
                else:
                    # Of a sum of two sizes, the part of second order counts with another term.
                    sizes[term.name] = combine((share * beyond, form))
        return sizes

    def _exact(self, form: LinearForm) -> LinearForm:
        """Return what a form is without roundings."""
        kept = len(form) - len(self.rounded)
        return [*form[:kept], *(Fraction(0) for _ in form[kept:])]


def _shortened(share: Fraction, factor: Fraction, form: LinearForm) -> LinearForm:
    """Return a share of what is a factor times another form, in short numbers."""
    return combine((short(share * factor) / factor if factor else ONE, form))
