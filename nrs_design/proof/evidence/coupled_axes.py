"""One quadratic function for all axes of a robot at once, while they act on each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import lcm
from typing import Any, ClassVar, Self

from nrs_design.proof.evidence.conewise_quadratic import find_odd_multipliers, in_threes
from nrs_design.proof.evidence.fields import (
    Matrix,
    matrix_fields,
    rate_words,
    read_dyadic,
    read_integer,
    read_ratio,
    read_roundings,
    rounding_fields,
)
from nrs_design.proof.evidence.function import AbstractFunction, is_square
from nrs_design.proof.exact import (
    IntegerMatrix,
    lyapunov_decrease,
    lyapunov_factor,
    multiply,
    scaled,
)
from nrs_design.proof.matrix import RationalMatrix, leading, with_crossing
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import Steps, find_odd_roundings
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted

Forms = Iterator[tuple[str, IntegerMatrix]]
NO_COUPLING = "the system does not say what axes do to each other"


@dataclass(frozen=True, slots=True)
class CoupledAxes(AbstractFunction):
    """``V = sum w_i' Q w_i`` over all axes decreases, ``w_i = (y_i, max(delta_i, 0))``.

    Every axis is in a mode of its own, in contact or free, with ``x' = A x + B d`` and, over all
    axes, ``sum d_ik^2 <= sum (q_k x_i)^2`` for every coupling k. With one tau_k for all modes, V
    decreases at the rate alpha if these are positive definite (S-procedure, axis by axis):

    - Q, and in contact, for every mode, the form
      ``[[-(A'Q + QA + 2 alpha Q) - sum tau_k q_k' q_k, -Q B], [-B'Q, diag(tau)]]``;
    - free: the same for the block of y of every free mode, of its B and q, and of Q;
    - deflected without force, where an environment could pull: for every free mode and every force
      f, the form of the free mode in all states, plus ``lambda (e f + f' e')`` with a lambda >= 0
      of its own.

    Where the system has no contact to lose, the first is all there is, and w_i is x_i.

    In discrete time, the forms are those of `nrs_design.proof.steps.Steps` for every motion, with
    the tau of what axes do to each other, and with those of what their arithmetic rounds if that is
    covered; their sums over the axes give ``V+ <= rho^2 V``.
    """

    kind: ClassVar[str] = "coupled-axes"
    bounds_at_once: ClassVar[bool] = True
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True
    covers_coupling: ClassVar[bool] = True

    Q: Matrix  # Shape (n, n). Numerators of the symmetric matrix.
    denominator_log2: int  # Q, tau and lambda are these numerators over two to this power
    rate: Fraction  # The alpha in 1/s, or rho per step
    taus: tuple[int, ...]  # One for each coupling of the system
    # The lambdas, as in `nrs_design.proof.evidence.conewise_quadratic`: in continuous time for each
    # free mode and each force in turn; none where contact is kept.
    multipliers: tuple[int, ...] = ()
    # Over the denominator of Q: the multipliers of `nrs_design.proof.steps.Steps`, if what the
    # arithmetic rounds is covered.
    roundings: tuple[int, ...] = ()

    @property
    def covers_rounding(self) -> bool:
        """Whether it has the multipliers for it."""
        return bool(self.roundings)

    @property
    def is_common_quadratic(self) -> bool:
        """True: for one axis alone in contact, it is one for all modes."""
        return True

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the conditions are concave in the modes."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that there is a coupling, shapes, the rate, and the signs of the lambdas."""
        if not system.couplings:
            return NO_COUPLING
        if not is_square(self.Q, system.order):
            return f"Q is not a {system.order} x {system.order} matrix"
        if len(self.taus) != len(system.couplings):
            return "there is not one multiplier for each coupling"
        if (odd := find_odd_multipliers(self.multipliers, system)) is not None:
            return odd
        if (odd := find_odd_roundings(self.roundings, system)) is not None:
            return odd
        return self.find_rate_misfit(system.time)

    def forms(self, system: SwitchedSystem) -> Forms:
        """Yield Q and the decreases in contact, free, and while an environment lags."""
        yield "Q is not symmetric and positive definite", self.Q
        if system.time is Time.DISCRETE:
            for where, form in self._steps().forms(system):
                yield _failure(where), form
            return
        for k, mode in enumerate(system.modes):
            form, _ = self._form(self.Q, mode.A, *_parts(system, k), 1)
            yield _failure(f"in mode {mode.name}"), form
        free = () if system.contact is None else system.contact.free
        for k, mode in enumerate(free, len(system.modes)):
            inner = RationalMatrix(tuple(leading(mode.A.numerators)), mode.A.denominator)
            columns, rows = _parts(system, k)
            moved = [RationalMatrix(B.numerators[:-1], B.denominator) for B in columns]
            seen = [RationalMatrix((_row(q)[:-1],), q.denominator) for q in rows]
            form, _ = self._form(leading(self.Q), inner, moved, seen, 1)
            yield _failure(f"in free motion, mode {mode.name}"), form
        pulls = () if system.contact is None else system.contact.pulls
        pairs = product(enumerate(free, len(system.modes)), pulls)
        for ((k, mode), f), multiplier in zip(pairs, self.multipliers, strict=True):
            form, factor = self._form(self.Q, mode.A, *_parts(system, k), f.denominator)
            weight = multiplier * (factor // f.denominator)
            pull = [weight * entry for entry in _row(f)]
            lagging = with_crossing(form, len(self.Q) - 1, pull)
            yield _failure(f"while the environment lags, mode {mode.name}"), lagging

    def _steps(self) -> Steps:
        """Return the conditions in discrete time."""
        crossing, *lagging = self.multipliers or (0,)
        return Steps(
            self.Q,
            self.denominator_log2,
            self.rate**2,
            crossing,
            self.roundings,
            lagging=in_threes(lagging),
            couplings=self.taus,
        )

    def _form(
        self,
        Q: IntegerMatrix,
        A: RationalMatrix,
        columns: Sequence[RationalMatrix],
        rows: Sequence[RationalMatrix],
        clear: int,
    ) -> tuple[list[list[int]], int]:
        """Return the form of one motion, times a positive number, and that number.

        Parameters
        ----------
        Q : integer matrix, shape (n, n)
            Of the states that move.
        A : RationalMatrix, shape (n, n)
            How they move.
        columns, rows : sequence of RationalMatrix, shapes (n, 1) and (1, n)
            The B and the q, one for each tau.
        clear : int
            The number is a multiple of this one.
        """
        own = lyapunov_factor(A.denominator, self.rate)
        squares = (q.denominator**2 for q in rows)
        factor = lcm(own, clear, *squares, *(B.denominator for B in columns))
        form = scaled(lyapunov_decrease(A.numerators, A.denominator, Q, self.rate), factor // own)
        for tau, q in zip(self.taus, rows, strict=True):
            weight = tau * (factor // q.denominator**2)
            for i, left in enumerate(_row(q)):
                for j, right in enumerate(_row(q)):
                    form[i][j] -= weight * left * right
        for B in columns:
            sides = multiply(Q, scaled(B.numerators, -(factor // B.denominator)))
            form = [[*row, *side] for row, side in zip(form, sides, strict=True)]
        across = [list(column) for column in zip(*form, strict=True)][len(Q) :]
        for i, (tau, side) in enumerate(zip(self.taus, across, strict=True)):
            form.append([*side, *(factor * tau * (i == j) for j in range(len(self.taus)))])
        return form, factor

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution of all axes."""
        names = ", ".join(item.name for item in system.couplings)
        modes = counted(len(system.modes), "mode")
        if system.contact is None:
            moves, w = f"{modes}, switching arbitrarily", "where w_i is the state of an axis,"
        else:
            free = counted(len(system.contact.free), "mode")
            moves = (
                f"{modes} in contact and {free} of free motion, switching arbitrarily, with "
                "contact lost and made again at any time"
            )
            w = (
                "where w_i holds the states of an axis other than its deflection, and the "
                "deflection where it is positive,"
            )
        end = "" if system.contact is None else " Where free motion ends is not claimed."
        discrete = system.time is Time.DISCRETE
        bound = "rho^t |w(0)|" if discrete else "exp(-alpha t) |w(0)|"
        return (
            "For any number of axes that act on each other within the stated bounds "
            f"({names}), which are taken on trust, each by itself in any of {moves}, every "
            "solution satisfies "
            f"|w(t)| <= {bound} with {rate_words(self.rate, system.time)}, {w} "
            f"in the norm |w|^2 = sum of w_i' Q w_i over the axes.{end}"
        )

    def to_fields(self) -> dict[str, Any]:
        """Return Q, the rate and the multipliers."""
        return {
            "Q": matrix_fields(self.Q, self.denominator_log2),
            "rate": str(self.rate),
            "taus": list(self.taus),
            "multipliers": list(self.multipliers),
            **rounding_fields(self.roundings),
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read Q, the rate and the multipliers."""
        Q, denominator_log2 = read_dyadic(fields["Q"])
        taus, multipliers = (
            tuple(read_integer(entry) for entry in fields[key]) for key in ("taus", "multipliers")
        )
        rate, roundings = read_ratio(fields["rate"]), read_roundings(fields)
        return cls(Q, denominator_log2, rate, taus, multipliers, roundings)


def _failure(where: str) -> str:
    return f"V does not decrease at the claimed rate {where}"


def _row(q: RationalMatrix) -> tuple[int, ...]:
    """Return the numerators of the only row."""
    (row,) = q.numerators
    return row


def _parts(system: SwitchedSystem, k: int) -> tuple[list[RationalMatrix], list[RationalMatrix]]:
    """Return the B and the q of the k-th mode; free modes come after those in contact."""
    couplings, n = system.couplings, system.order
    # What disturbs is zero in a statement about stability.
    rows = (item.rows[k] for item in couplings)
    seen = [RationalMatrix((_row(q)[:n],), q.denominator) for q in rows]
    return [item.columns[k] for item in couplings], seen
