"""An ellipsoid in which motions decay although signals of the loop saturate."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.proof.between import between
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows, find_odd_form, in_seconds
from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS, Matrix, rate_words
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix, bordered, multiply
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
NOTHING_SATURATES = "the system does not say what saturates"


@dataclass(frozen=True, slots=True, kw_only=True)
class SaturatedEllipsoid(AbstractEvidence):
    """``V = w' Q w`` decreases wherever ``V <= 1``, although signals are cut off at their limits.

    Every signal ``s = sat(a)`` has a row h with ``|h w| <= limit`` in the ellipsoid (Hu and Lin),
    or in discrete time one in every mode.
    There s is a mixture of its argument a and of ``h w``, so the loop moves as a mixture of the
    matrices that have, for each signal, one or the other in its place: `Saturation.changes`. With
    w the state, or ``w = (y, max(delta, 0))`` where the system says how contact is lost, V
    decreases

    at the rate 2 alpha (in discrete time it keeps the share rho^2) in every step of the modes of
    `nrs_design.proof.between`, as `nrs_design.proof.steps` says, with one multiplier for each fact:
    where contact is lost, and for roundings. And the set ``V <= 1`` lies where the rows keep their
    limits: ``[[Q, h'], [h, limit^2]] > 0``. All are linear in the matrices: convex combinations of
    modes are covered.
    """

    kind: ClassVar[str] = "saturated-ellipsoid"
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True

    Q: Matrix  # Shape (n, n). Numerators of the symmetric matrix.
    denominator_log2: int  # Q is these numerators over two to this power
    rate: Fraction  # The alpha in 1/s, or rho per step
    # Shape (signals, n), or (signals times modes, n). Numerators of the rows h: one for each
    # signal, or in discrete time one for each in every mode, and after them in the free modes.
    H: Matrix
    H_denominator_log2: int  # H is these numerators over two to this power
    # Motions that begin at the start of the system, at this size at most, begin in ``V <= 1``.
    level: Fraction
    # In discrete time, all over the denominator of Q: in the order of `multiplier_names`; and one
    # for each rounding of the system, if they are covered.
    multipliers: tuple[int, ...] = ()
    roundings: tuple[int, ...] = ()

    @property
    def covers_rounding(self) -> bool:
        """Whether it has the multipliers for it."""
        return bool(self.roundings)

    @property
    def shows(self) -> Shows:
        """Decay from a region."""
        return Shows.REGION

    @property
    def quadratic(self) -> tuple[IntegerMatrix, int]:
        """The Q of the ellipsoid."""
        return [list(row) for row in self.Q], self.denominator_log2

    @property
    def start_size(self) -> Fraction:
        """The level."""
        return self.level

    def start_rate(self, system: SwitchedSystem) -> Fraction:
        """Return alpha in 1/s, or what is not above it: ``1 - rho`` in every step."""
        if system.time is Time.CONTINUOUS:
            return self.rate
        return (1 - self.rate) / (system.sample_time or 1)

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that something saturates, shapes, and the signs of rate and level."""
        if system.saturation is None:
            return NOTHING_SATURATES
        if system.contact is not None and system.contact.pulls:
            return "the environment could pull, which is not covered where signals saturate"
        if (odd := find_odd_form(self.Q, self.denominator_log2, system.order)) is not None:
            return odd
        if not 0 <= self.H_denominator_log2 <= MAX_INTEGER_BITS:
            return "the denominator of H is out of range"
        rows = len(system.saturation.signals)
        by_mode = system.time is Time.DISCRETE and len(self.H) == rows * len(system.every_mode)
        if len(self.H) != rows and not by_mode:
            return f"H has not {rows} rows of {system.order} entries"
        if any(len(row) != system.order for row in self.H):
            return f"H has not {rows} rows of {system.order} entries"
        if self.rate <= 0 or self.level <= 0:
            return "the rate or the level is not positive"
        if system.time is Time.DISCRETE and self.rate >= 1:
            return "the rate is not one of exponential decay"
        rounded = len(system.roundings) if self.roundings else 0
        for signal in system.saturation.signals:
            if rounded and not signal.errors:
                return f"{signal.name} does not say what the arithmetic rounds"
        return find_odd_multiplier(
            (self.multipliers, len(multiplier_names(system)), "condition that needs it"),
            (self.roundings, rounded, "rounding"),
        )

    def forms(self, system: SwitchedSystem) -> Forms:
        """Yield Q, the decreases in contact and free, and what the ellipsoid must and may hold."""
        assert system.saturation is not None  # find_misfit
        yield "Q is not symmetric and positive definite", self.Q
        yield from self._decreases(system)
        Q = RationalMatrix(self.Q, 2**self.denominator_log2).fractions()
        signals = system.saturation.signals
        # Modes may share their rows: each is looked at once.
        for i, h in dict.fromkeys((k % len(signals), tuple(h)) for k, h in enumerate(self.H)):
            row = [Fraction(entry, 2**self.H_denominator_log2) for entry in h]
            form = bordered(Q, row, signals[i].limit ** 2)
            yield f"the row of {signals[i].name} is beyond its limit", form.numerators
        start = system.saturation.start
        for state in start.states:
            x = state.fractions()
            ((value,),) = multiply([*zip(*x, strict=True)], multiply(Q, x))
            left = RationalMatrix.from_rows([[1 - self.level**2 * value]])
            yield f"the ellipsoid does not hold the stated {start.name}", left.numerators

    def _decreases(self, system: SwitchedSystem) -> Forms:
        acting = Acting(rounding=bool(self.roundings))
        whole = between(system, self._held(system), rounding=acting.rounding)
        keeps = 2 * self.rate if system.time is Time.CONTINUOUS else self.rate**2
        steps = steps_of(whole, acting, grain_of(keeps), lost=True)
        known = by_fact(multiplier_names(system), self.multipliers, self.roundings)
        for where, form in forms_of_one(steps, self.Q, keeps, known, self.denominator_log2):
            yield f"V does not decrease at the claimed rate {where}", form

    def _held(self, system: SwitchedSystem) -> list[list[list[Fraction]]]:
        """Return the rows of every mode and free mode."""
        assert system.saturation is not None
        rows = RationalMatrix(self.H, 2**self.H_denominator_log2).fractions()
        count, modes = len(system.saturation.signals), range(len(system.every_mode))
        return [rows[k * count : (k + 1) * count] if len(rows) > count else rows for k in modes]

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State from where motions decay, how fast, and what saturates."""
        assert system.saturation is not None  # find_misfit
        signals, start = system.saturation.signals, system.saturation.start
        limits = [f"the {s.name} at {rounded_up(s.limit, s.unit)}" for s in signals]
        states, lost = "the state,", ""
        if system.contact is not None:
            states = (
                "the states other than the deflection, and the deflection where it is positive "
                "(zero elsewhere),"
            )
            lost = ", contact lost and made again at any time"
        decay = "|w(t)| <= exp(-alpha t) |w(0)|"
        if system.time is Time.DISCRETE:
            decay = "|w(m)| <= rho^m |w(0)| after m steps"
        seconds = ""
        if system.time is Time.DISCRETE and system.sample_time is not None:
            seconds = f" {in_seconds(self.rate, system.sample_time)}"
        return (
            f"Although signals saturate, each at the stated limit or beyond it ({', '.join(limits)}"
            f"): every motion that begins in the ellipsoid w' Q w <= 1 stays in it, and "
            f"{decay} with {rate_words(self.rate, system.time)} in the norm "
            f"|w| = sqrt(w' Q w), where w holds {states} switching arbitrarily{lost}, with no "
            f"disturbance. In particular: every motion that begins at rest with a {start.name} up "
            f"to {rounded_down(self.level, start.unit)}{start.exception}, and all else "
            f"zero.{seconds}"
        )

    def find_unsayable(self, system: SwitchedSystem) -> str | None:
        """Say that it says nothing where nothing saturates."""
        return NOTHING_SATURATES if system.saturation is None else None
