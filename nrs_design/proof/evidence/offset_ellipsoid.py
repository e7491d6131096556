"""An ellipsoid off the origin that a bounded disturbance cannot leave where contact may be lost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.proof.evidence.abstract import find_odd_form
from nrs_design.proof.evidence.invariant_ellipsoid import Forms, InvariantEllipsoid
from nrs_design.proof.exact import is_symmetric, scaled
from nrs_design.proof.matrix import RationalMatrix, with_crossing
from nrs_design.proof.mode import Time
from nrs_design.proof.offset import offset_steps
from nrs_design.proof.steps import Step, by_fact, find_odd_multiplier, forms_of_one, grain_of
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class OffsetEllipsoid(InvariantEllipsoid):
    """``W = [1; w]' Q [1; w] <= 0`` is never left from rest, and there ``|z| <= level``.

    As `InvariantEllipsoid`, with ``w = (y, max(delta, 0))``, but Q is a form of the state behind a
    one, and what is known of signs is used: with the products p of `nrs_design.proof.offset` and a
    multiplier m >= 0 for each,

        discrete    (1 - a) W - W+ - sum m p > 0,    0 < a < 1
        continuous  -(W' + a W) - sum m p > 0

    so W falls where it is positive, and does not become so. At rest ``W <= 0``. The block of w is
    positive definite, so that W is convex. For every row q of the output and both signs,
    ``level -+ q w + W - m delta > 0``, so ``|z| < level + W``.
    """

    kind: ClassVar[str] = "offset-ellipsoid"
    surface: ClassVar[str] = " (the surface stays in its place, or follows the axis)"

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check names, shapes, rest, and the signs of share, level and multipliers."""
        if (unknown := self.find_unsayable(system)) is not None:
            return unknown
        if system.contact is None:
            return "it is about an axis that may lose contact"
        if (odd := find_odd_form(self.Q, self.denominator_log2, system.order + 1)) is not None:
            return odd
        if not is_symmetric(self.Q):
            return "Q is not symmetric"
        if self.Q[0][0] > 0:
            return "rest is not within it"
        if len(self.shares) != 1:
            return "there is not one share"
        if self.shares[0] <= 0 or (system.time is Time.DISCRETE and self.shares[0] >= 1):
            return "the share is not that of a set that is not left"
        if (odd := self._find_odd_multiplier(system)) is not None:
            return odd
        return None if self.level > 0 else "the level is not positive"

    def _find_odd_multiplier(self, system: SwitchedSystem) -> str | None:
        rounded = len(system.roundings) if self.roundings else 0
        return find_odd_multiplier(
            (self.roundings, rounded, "rounding"),
            (self.multipliers, len(self.facts(system)), "product"),
        )

    def steps(self, system: SwitchedSystem) -> Iterator[Step]:
        """Yield the steps of its system, with the products that are known in each."""
        channels, keeps = self.bound(system).channels, self._keeps(system)
        return offset_steps(system, channels, grain_of(keeps), rounding=bool(self.roundings))

    def facts(self, system: SwitchedSystem) -> tuple[str, ...]:
        """Return what each multiplier belongs to: products of steps, then ends of the output."""
        products = (name for step in self.steps(system) for name, *_ in step.products)
        return tuple(dict.fromkeys((*products, *(name for name, *_ in self.ends(system)))))

    def forms(self, system: SwitchedSystem) -> Forms:
        """Yield Q, the block of w, the condition of every step, and those of the output."""
        yield "the block of w in Q is not positive definite", [row[1:] for row in self.Q[1:]]
        known = by_fact(self.facts(system), self.multipliers, self.roundings)
        motions = forms_of_one(
            self.steps(system), self.Q, self._keeps(system), known, self.denominator_log2
        )
        yield from ((f"the ellipsoid can be left {where}", form) for where, form in motions)
        # Twice the condition, times the denominators.
        for name, row, sign in self.ends(system):
            below = row.denominator * self.level.denominator
            form = scaled(self.Q, 2 * below)
            form[0][0] += int(2 * below * self.level) << self.denominator_log2
            scale = -sign * self.level.denominator << self.denominator_log2
            q = [0, *(scale * entry for entry in row.numerators[0])]
            q[-1] -= below * known(name)
            yield f"{self.output} can be beyond the level", with_crossing(form, 0, q)

    def ends(self, system: SwitchedSystem) -> Iterator[tuple[str, RationalMatrix, int]]:
        """Yield every row of the output with both signs, and what its multiplier is called."""
        for k, row in enumerate(self.bound(system).output.rows, 1):
            yield from ((f"{self.output} {k}: {sign}", row, sign) for sign in (1, -1))

    def _keeps(self, system: SwitchedSystem) -> Fraction:
        share = self.shares[0]
        return share if system.time is Time.CONTINUOUS else 1 - share
