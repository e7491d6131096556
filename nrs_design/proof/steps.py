"""TRUSTED: what one step does to a quadratic function, with disturbances and rounded arithmetic.

The state moves by ``x+ = A x + B d + C r`` with ``|d_i| <= bound_i`` and ``|r_i| <= |q_i (x, d)|``.
Every motion gives one form in (x, d, r)

    keeps before(x) + sum weight_i d_i^2 + sum tau_i (r_i^2 - (q_i (x, d))^2) - after(x+)

with all ``tau_i >= 0``. If it is positive definite, ``after <= keeps before + sum weight_i d_i^2``
for every error within its limit (S-procedure). Where contact may be lost, before and after are
``y' Q_yy y`` free and ``x' Q x`` in contact; where a step loses it, ``delta`` is positive and its
next value, the last row times (x, d, r), is not, so that twice lambda >= 0 times their product is
added. An environment that could pull lags instead: delta is positive and a force ``q x`` is not, a
free mode rules, and twice mu >= 0 times their product is added, whether delta stays positive or
not. One lambda and one tau_i for all modes, and one mu for each force, keep the forms
concave in the maps.

Where axes act on each other, ``x+ = A x + B d + C r + D w`` with ``sum |w_k|^2 <= sum |q_k (x, d,
r)|^2`` over the axes only, not for each of them. The form of an axis then has w as further entries
and ``tau_k (w_k^2 - (q_k (x, d, r))^2)`` as further terms, and is not positive by itself; but as
tau_k is one for all motions, these terms add up to nothing positive over the axes, whatever motion
each of them is in, and the same follows for the sums of before and after over all axes.

The forms are written in integers: every entry of (x, d, r) is counted in a unit of its own, the
least in which what multiplies it in [A, B, C] and in the q_i is an integer. With these units on the
diagonal of D, a form F becomes ``D F D``, which is positive definite iff F is. One denominator for
all of them would make the integers several times as long.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, isqrt, lcm

from nrs_design.proof.channels import Coupling, Rounding
from nrs_design.proof.exact import IntegerMatrix, add, congruence, transpose
from nrs_design.proof.matrix import RationalMatrix, leading, with_crossing
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class _Motion:
    """What one mode does, in units in which all of it is integer."""

    units: Sequence[int]  # One for each entry of (x, d, r, w)
    rows: IntegerMatrix  # The rows of ``[A, B, C, D]``
    errors: IntegerMatrix  # The q_i of r and of w, over (x, d, r, w)


@dataclass(frozen=True, slots=True)
class Steps:
    """The numbers of a quadratic function in discrete time."""

    Q: IntegerMatrix  # Shape (n, n). Numerators of the symmetric matrix.
    denominator_log2: int  # Q, lambda and the tau are these numerators over two to this power
    # What a step leaves of the function: rho^2, or one minus the shares of the disturbances.
    keeps: Fraction
    crossing: int = 0  # The lambda; it says nothing where contact is kept
    # The tau, in the order of the roundings of the system; none if it is to compute exactly.
    roundings: tuple[int, ...] = ()
    channels: tuple[int, ...] = ()  # Which disturbances of the system act
    weights: tuple[Fraction, ...] = ()  # One for each of them
    # For each force that could pull: the mu of steps that leave the deflection positive, and mu and
    # lambda of those that do not. A mu is that of the numerators of the force.
    lagging: tuple[tuple[int, int, int], ...] = ()
    # Numerators of the function after a step, over the same power; None for Q.
    after: IntegerMatrix | None = None
    # The tau, in the order of the couplings of the system; none if axes do not act on each other.
    couplings: tuple[int, ...] = ()

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the form of every motion, in units of its own, with where it is."""
        n, after = len(self.Q), self.Q if self.after is None else self.after
        for k, mode in enumerate(system.modes):
            motion = self._motion(system, k, mode.A)
            left, (*others, _) = self._left(self.Q, motion), motion.rows
            yield f"in mode {mode.name}", _less(left, motion.rows, after)
            if system.contact is None:
                continue
            lost = _less(left, others, leading(after))
            lost = _with_loss(lost, motion, n, self.crossing)
            yield f"where contact is lost in mode {mode.name}", lost
        free = () if system.contact is None else system.contact.free
        for k, mode in enumerate(free, len(system.modes)):
            whole = self._motion(system, k, mode.A)
            motion = _undeflected(whole, n - 1)
            left, (*others, _) = self._left(leading(self.Q), motion), motion.rows
            yield f"in free motion, mode {mode.name}", _less(left, others, leading(after))
            yield f"where contact is made, mode {mode.name}", _less(left, motion.rows, after)
            yield from self._lagging(system, mode.name, whole, after)

    def _lagging(
        self, system: SwitchedSystem, name: str, motion: _Motion, after: IntegerMatrix
    ) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the forms of a free mode while the deflection is positive."""
        contact, n = system.contact, len(self.Q)
        left, (*others, _) = self._left(self.Q, motion), motion.rows
        pulls = () if contact is None else contact.pulls
        for q, (stays, leaves, crossing) in zip(pulls, self.lagging, strict=True):
            force = [
                motion.units[n - 1] * f * u
                for f, u in zip(q.numerators[0], motion.units, strict=False)
            ]
            still = _less(left, motion.rows, after)
            pulled = with_crossing(still, n - 1, [stays * entry for entry in force])
            yield f"while the environment lags, mode {name}", pulled
            lost = _less(left, others, leading(after))
            lost = with_crossing(lost, n - 1, [leaves * entry for entry in force])
            lost = _with_loss(lost, motion, n, crossing)
            yield f"where a lagging environment is left, mode {name}", lost

    def _motion(self, system: SwitchedSystem, k: int, A: RationalMatrix) -> _Motion:
        """Return the k-th mode in the least units that make it integer."""
        covered: tuple[Rounding | Coupling, ...] = (
            *system.roundings[: len(self.roundings)],
            *system.couplings[: len(self.couplings)],
        )
        parts = [A, *(system.channels[i].columns[k] for i in self.channels)]
        parts += [item.columns[k] for item in covered]
        columns = [(column, M.denominator) for M in parts for column in transpose(M.numerators)]
        count = len(self.Q) + len(system.channels)
        errors = [self._error(item.rows[k], count) for item in covered]
        least = [_root(self.keeps.denominator)] * len(self.Q)
        least += [*(weight.denominator for weight in self.weights), *(1 for _ in covered)]
        units = [
            lcm(unit, d // gcd(d, *column), *(e // gcd(e, q[j]) for q, e in errors))
            for j, (unit, (column, d)) in enumerate(zip(least, columns, strict=True))
        ]
        counted = [
            [unit * entry // d for entry in column]
            for unit, (column, d) in zip(units, columns, strict=True)
        ]
        sizes = [
            [unit * entry // e for unit, entry in zip(units, q, strict=True)] for q, e in errors
        ]
        return _Motion(units, transpose(counted), sizes)

    def _error(self, row: RationalMatrix, count: int) -> tuple[list[int], int]:
        """Return a q over (x, d, r, w) with the d that act and the r that count, and below it.

        Only the q of a coupling goes beyond the first `count` entries, to all r.
        """
        (entries,), n = row.numerators, len(self.Q)
        acting = [entries[n + i] for i in self.channels]
        rounded = entries[count : count + len(self.roundings)] or (0 for _ in self.roundings)
        return [*entries[:n], *acting, *rounded, *(0 for _ in self.couplings)], row.denominator

    def _left(self, before: IntegerMatrix, motion: _Motion) -> list[list[int]]:
        """Return the form of one motion without what comes after it."""
        n, units = len(before), motion.units
        form = [[0] * len(units) for _ in units]
        p, q = self.keeps.as_integer_ratio()
        for i, row in enumerate(before):
            for j, entry in enumerate(row):
                form[i][j] = units[i] * units[j] // q * p * entry
        for i, weight in enumerate(self.weights, n):
            form[i][i] = int(weight * units[i] ** 2) << self.denominator_log2
        taus = (*self.roundings, *self.couplings)
        for i, tau in enumerate(taus, n + len(self.weights)):
            form[i][i] = tau * units[i] ** 2
        for tau, error in zip(taus, motion.errors, strict=True):
            entries = [(i, entry) for i, entry in enumerate(error) if entry]
            for a, left in entries:
                for b, right in entries:
                    form[a][b] -= tau * left * right
        return form


def _root(number: int) -> int:
    """Return a natural number with a square that is a multiple of another."""
    root = isqrt(number)
    return root if root * root == number else number


def _less(left: IntegerMatrix, rows: IntegerMatrix, after: IntegerMatrix) -> list[list[int]]:
    """Subtract the function after a step from what may be left of it."""
    return add(left, congruence(rows, after), -1)


def _with_loss(form: IntegerMatrix, motion: _Motion, n: int, crossing: int) -> list[list[int]]:
    """Add twice lambda times the deflection times its next value."""
    factor = crossing * motion.units[n - 1]
    return with_crossing(form, n - 1, [factor * entry for entry in motion.rows[n - 1]])


def _undeflected(motion: _Motion, k: int) -> _Motion:
    """Return a motion where the k-th state is zero."""
    rows, errors = ([_without(row, k) for row in M] for M in (motion.rows, motion.errors))
    return _Motion(_without(motion.units, k), rows, errors)


def _without(row: Sequence[int], k: int) -> list[int]:
    return [*row[:k], *row[k + 1 :]]


def find_odd_roundings(roundings: tuple[int, ...], system: SwitchedSystem) -> str | None:
    """TRUSTED: say why multipliers do not belong to the roundings of a system, or None.

    Parameters
    ----------
    roundings : tuple of int
        The tau of `Steps`; none for exact arithmetic.
    system : SwitchedSystem
        Whose arithmetic it is.
    """
    if roundings and len(roundings) != len(system.roundings):
        return "there is not one multiplier for each rounding"
    if any(entry < 0 for entry in roundings):
        return "the multiplier of a rounding is negative"
    return None
