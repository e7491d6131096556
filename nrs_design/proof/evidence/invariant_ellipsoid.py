"""An ellipsoid that a bounded disturbance cannot leave, and how far it reaches in one output."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence.abstract import AbstractEvidence, Bound, Shows, find_odd_form
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix, bordered
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import (
    Acting,
    by_fact,
    find_odd_multiplier,
    forms_of_one,
    grain_of,
    multiplier_names,
    steps_of,
)
from nrs_design.proof.system import SwitchedSystem

Forms = Iterator[tuple[str, IntegerMatrix]]


@dataclass(frozen=True, slots=True)
class InvariantEllipsoid(AbstractEvidence):
    """``V = w' Q w <= 1`` is never left while ``|d_i| <= bound_i``, and there ``|z| <= level``.

    The state moves by ``x' = A x + B d`` (``x+ = A x + B d``), and z is one of the rows q of an
    output times w, with ``w = x``, or ``w = (y, max(delta, 0))`` where contact may be lost. Every
    disturbance d_i has a share a_i > 0, and a is their sum. In continuous time

        [[-(A'Q + QA + a Q), -QB], [-B'Q, diag(a_i/bound_i^2)]] > 0

    gives ``V' <= sum a_i (d_i^2/bound_i^2 - V)``, which is not positive where ``V = 1``; in
    discrete time

        [[(1 - a) Q - A'QA, -A'QB], [-B'QA, diag(a_i/bound_i^2) - B'QB]] > 0

    gives ``V+ <= (1 - a) V + sum a_i d_i^2/bound_i^2``. And ``[[Q, q'], [q, level^2]] > 0`` gives
    ``z^2 < level^2 V``. Where contact may be lost, the same holds for free motion and in between,
    with the multipliers of `nrs_design.proof.steps`; the disturbances then take part in where the
    deflection goes.
    """

    kind: ClassVar[str] = "invariant-ellipsoid"
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True
    surface: ClassVar[str] = ""  # What its claim says of the surface that may be lost

    channels: tuple[str, ...]  # Names of the disturbances that act at once
    output: str  # Name of the output
    Q: Matrix  # Shape (n, n). Numerators of the symmetric matrix.
    denominator_log2: int  # Q is these numerators over two to this power
    shares: tuple[Fraction, ...]  # The a_i: in 1/s, or per step with a sum below 1
    level: Fraction  # In the unit of the output
    # Over the denominator of Q, in the order of `multiplier_names`; none where contact is kept.
    multipliers: tuple[int, ...] = ()
    # Over the denominator of Q: one for each rounding of the system, if they are covered.
    roundings: tuple[int, ...] = ()

    @property
    def shows(self) -> Shows:
        """A bound."""
        return Shows.BOUND

    @property
    def covers_rounding(self) -> bool:
        """Whether it has the multipliers for it."""
        return bool(self.roundings)

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the set is convex in contact, and free, and the multiplier is one for all modes."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check names, shapes, and the signs of shares, level and multipliers."""
        if (unknown := self.find_unsayable(system)) is not None:
            return unknown
        if (odd := find_odd_form(self.Q, self.denominator_log2, system.order)) is not None:
            return odd
        if (odd := self._find_odd_multiplier(system)) is not None:
            return odd
        if len(self.shares) != len(self.channels):
            return "there is not one share for each disturbance"
        if min(self.shares) <= 0 or (system.time is Time.DISCRETE and sum(self.shares) >= 1):
            return "the shares are not those of a set that is not left"
        return None if self.level > 0 else "the level is not positive"

    def _find_odd_multiplier(self, system: SwitchedSystem) -> str | None:
        # Without multipliers for them, it is about exact arithmetic.
        rounded = len(system.roundings) if self.roundings else 0
        return find_odd_multiplier(
            (self.multipliers, len(multiplier_names(system)), "condition that needs it"),
            (self.roundings, rounded, "rounding"),
        )

    def find_unsayable(self, system: SwitchedSystem) -> str | None:
        """Say which of its names the system does not have, or None."""
        known = {channel.name for channel in system.channels}
        if not self.channels or len(set(self.channels)) < len(self.channels):
            return "it names no disturbance, or one of them twice"
        if not known.issuperset(self.channels):
            return "the system has no disturbance of that name"
        if self.output not in {output.name for output in system.outputs}:
            return "the system has no output of that name"
        return None

    def forms(self, system: SwitchedSystem) -> Forms:
        """Yield Q, the condition of every motion, and that of every row of the output."""
        yield "Q is not symmetric and positive definite", self.Q
        Q = RationalMatrix(self.Q, 2**self.denominator_log2).fractions()
        motions = self._motions(system)
        yield from ((f"the ellipsoid can be left {where}", form) for where, form in motions)
        failure = f"{self.output} can be beyond the level"
        for q in self.bound(system).output.rows:
            yield failure, bordered(Q, q.fractions()[0], self.level**2).numerators

    def _motions(self, system: SwitchedSystem) -> Forms:
        """Return the condition of every step, with where it is."""
        bound = self.bound(system)
        weights = tuple(a / c.bound**2 for a, c in zip(self.shares, bound.channels, strict=True))
        channels = tuple(system.channels.index(channel) for channel in bound.channels)
        acting = Acting(channels, weights, bool(self.roundings))
        keeps = bound.share if system.time is Time.CONTINUOUS else 1 - bound.share
        steps = steps_of(system, acting, grain_of(keeps), lost=True)
        known = by_fact(multiplier_names(system), self.multipliers, self.roundings)
        return forms_of_one(steps, self.Q, keeps, known, self.denominator_log2)

    def bound(self, system: SwitchedSystem) -> Bound:
        """Return the level with what it holds for."""
        output = next(item for item in system.outputs if item.name == self.output)
        by_name = {channel.name: channel for channel in system.channels}
        named = tuple(by_name[name] for name in self.channels)
        return Bound(output, self.level, named, sum(self.shares, Fraction(0)))

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State how far the output goes, from rest and in the long run."""
        bound = self.bound(system)
        output, named = bound.output, bound.channels
        lost = f", contact lost and made again at any time{self.surface}" if system.contact else ""
        sizes = [f"|{c.name}| <= {rounded_down(c.bound, c.unit)}" for c in named]
        steps = " at a step" if system.time is Time.DISCRETE else ""
        return (
            f"While {', '.join(sizes)} and nothing else disturbs, switching arbitrarily"
            f"{lost}: from rest, |{output.name}|{steps} never exceeds "
            f"{rounded_up(self.level, output.unit)}; from any state, it comes below every larger "
            f"value and stays there.{self._beside_limit(output, named)}"
        )

    def _beside_limit(self, output: Output, channels: Sequence[Channel]) -> str:
        """Say whether the level keeps the limit of the output, or how much smaller a push does.

        All conditions are homogeneous: with disturbances of a share of their bounds, the level is
        the same share of itself.
        """
        if output.limit is None:
            return ""
        limit = rounded_down(output.limit, output.unit)
        if self.level <= output.limit:
            return f" The limit of {limit} is kept."
        share = output.limit / self.level
        smaller = (f"|{c.name}| <= {rounded_down(share * c.bound, c.unit)}" for c in channels)
        return (
            f" That the limit of {limit} is kept is not shown; it is, in proportion, for "
            f"{', '.join(smaller)}."
        )
