"""An ellipsoid that a bounded disturbance cannot leave, and how far it reaches in one output."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any, ClassVar, Self

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.conewise_quadratic import multiplier_count
from nrs_design.proof.evidence.fields import (
    MAX_INTEGER_BITS,
    Matrix,
    matrix_fields,
    read_dyadic,
    read_integer,
    read_ratio,
    read_text,
)
from nrs_design.proof.evidence.function import is_square
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix, leading, multiply, with_crossing
from nrs_design.proof.system import Channel, Mode, Output, SwitchedSystem, Time

Forms = Iterator[tuple[str, IntegerMatrix]]
Rows = Sequence[Sequence[Fraction]]
Moves = Sequence[tuple[Mode, list[Fraction]]]


@dataclass(frozen=True, slots=True)
class InvariantEllipsoid(AbstractEvidence):
    """``V = w' Q w <= 1`` is never left while ``|d| <= bound``, and there ``|z| <= level``.

    The state moves by ``x' = A x + B d`` (``x+ = A x + B d``), and z is one of the rows q of an
    output times w, with ``w = x``, or ``w = (y, max(delta, 0))`` where contact may be lost. In
    continuous time

        [[-(A'Q + QA + a Q), -QB], [-B'Q, a/bound^2]] > 0

    gives ``V' <= a (d^2/bound^2 - V)``, which is not positive where ``V = 1``; in discrete time

        [[(1 - a) Q - A'QA, -A'QB], [-B'QA, a/bound^2 - B'QB]] > 0

    gives ``V+ <= (1 - a) V + a d^2/bound^2``. And ``[[Q, q'], [q, level^2]] > 0`` gives
    ``z^2 < level^2 V``. Where contact may be lost, the same holds for free motion and in between,
    with the multipliers of `nrs_design.proof.evidence.conewise_quadratic`; the disturbance then
    takes part in where the deflection goes.

    Parameters
    ----------
    channel, output : str
        Names of the disturbance and of the output.
    Q : tuple of tuple of int, shape (n, n)
        Numerators of the symmetric matrix.
    denominator_log2 : int
        Q is these numerators over two to this power.
    share : Fraction
        The a: in 1/s, or per step below 1.
    level : Fraction
        In the unit of the output.
    multipliers : tuple of int
        Over the denominator of Q; none where contact is kept.
    """

    kind: ClassVar[str] = "invariant-ellipsoid"
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True

    channel: str
    output: str
    Q: Matrix
    denominator_log2: int
    share: Fraction
    level: Fraction
    multipliers: tuple[int, ...] = ()

    @property
    def shows(self) -> Shows:
        """A bound."""
        return Shows.BOUND

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the set is convex in contact, and free, and the multiplier is one for all modes."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check names, shapes, and the signs of share, level and multipliers."""
        contact = system.contact
        if (unknown := self._find_unknown(system)) is not None:
            return unknown
        if not is_square(self.Q, system.order):
            return f"Q is not a {system.order} x {system.order} matrix"
        if not 0 <= self.denominator_log2 <= MAX_INTEGER_BITS:
            return f"the denominator of Q is not two to a power up to {MAX_INTEGER_BITS}"
        if contact is not None and system.time is Time.DISCRETE and contact.pulls:
            return "in discrete time, an environment that could pull is not covered"
        needed = 0 if contact is None else multiplier_count(contact, system.time)
        if len(self.multipliers) != needed:
            return "there is not one multiplier for each condition that needs it"
        if min(self.multipliers, default=0) < 0:
            return "a multiplier is negative"
        if self.share <= 0 or (system.time is Time.DISCRETE and self.share >= 1):
            return "the share is not one of a set that is not left"
        return None if self.level > 0 else "the level is not positive"

    def _find_unknown(self, system: SwitchedSystem) -> str | None:
        if self.channel not in {channel.name for channel in system.channels}:
            return "the system has no disturbance of that name"
        if self.output not in {output.name for output in system.outputs}:
            return "the system has no output of that name"
        return None

    def forms(self, system: SwitchedSystem) -> Forms:
        """Yield Q, the condition of every motion, and that of every row of the output."""
        channel = next(item for item in system.channels if item.name == self.channel)
        output = next(item for item in system.outputs if item.name == self.output)
        yield "Q is not symmetric and positive definite", self.Q
        Q = RationalMatrix(self.Q, 2**self.denominator_log2).fractions()
        motions = _Motions(system, channel, Q, self.share, self._exact_multipliers())
        for where, form in motions.forms():
            yield f"the ellipsoid can be left {where}", RationalMatrix.from_rows(form).numerators
        for q in output.rows:
            row = q.fractions()[0]
            form = _bordered(Q, row, self.level**2)
            failure = f"{self.output} can be beyond the level"
            yield failure, RationalMatrix.from_rows(form).numerators

    def _exact_multipliers(self) -> list[Fraction]:
        return [Fraction(entry, 2**self.denominator_log2) for entry in self.multipliers]

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State how far the output goes, from rest and in the long run."""
        channel = next(item for item in system.channels if item.name == self.channel)
        output = next(item for item in system.outputs if item.name == self.output)
        lost = "" if system.contact is None else ", contact lost and made again at any time"
        size = rounded_down(channel.bound, channel.unit)
        steps = " at a step" if system.time is Time.DISCRETE else ""
        return (
            f"While |{channel.name}| <= {size} and nothing else disturbs, switching arbitrarily"
            f"{lost}: from rest, |{output.name}|{steps} never exceeds "
            f"{rounded_up(self.level, output.unit)}; from any state, it comes below every larger "
            f"value and stays there.{self._beside_limit(output)}"
        )

    def _beside_limit(self, output: Output) -> str:
        """Say whether the level keeps the limit of the output, if it has one."""
        if output.limit is None:
            return ""
        limit = rounded_down(output.limit, output.unit)
        if self.level <= output.limit:
            return f" The limit of {limit} is kept."
        return f" That the limit of {limit} is kept is not shown."

    def to_fields(self) -> dict[str, Any]:
        """Return the names, Q, share, level and multipliers."""
        return {
            "channel": self.channel,
            "output": self.output,
            "Q": matrix_fields(self.Q, self.denominator_log2),
            "share": str(self.share),
            "level": str(self.level),
            "multipliers": list(self.multipliers),
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the names, which must be those of the system, and the numbers."""
        Q, denominator_log2 = read_dyadic(fields["Q"])
        evidence = cls(
            read_text(fields["channel"]),
            read_text(fields["output"]),
            Q,
            denominator_log2,
            read_ratio(fields["share"]),
            read_ratio(fields["level"]),
            tuple(read_integer(entry) for entry in fields["multipliers"]),
        )
        if (unknown := evidence._find_unknown(system)) is not None:
            raise ValueError(unknown)
        return evidence


@dataclass(frozen=True, slots=True)
class _Motions:
    """Everything that the state can do, each with the condition that it does not leave V <= 1."""

    system: SwitchedSystem
    channel: Channel
    Q: Rows
    share: Fraction
    multipliers: Sequence[Fraction]

    def forms(self) -> Iterator[tuple[str, Rows]]:
        """Yield the condition of every motion, with where it is."""
        contact = self.system.contact
        free = () if contact is None else contact.free
        columns = [[row[0] for row in column.fractions()] for column in self.channel.columns]
        touching = list(zip(self.system.modes, columns, strict=False))
        flying = list(zip(free, columns[len(touching) :], strict=True))
        if self.system.time is Time.CONTINUOUS:
            yield from self._in_continuous_time(touching, flying)
        else:
            yield from self._in_discrete_time(touching, flying)

    def _in_continuous_time(self, touching: Moves, flying: Moves) -> Iterator[tuple[str, Rows]]:
        for mode, b in touching:
            yield f"in mode {mode.name}", self._flow(mode.A.fractions(), b, self.Q)
        inner = leading(self.Q)
        for mode, b in flying:
            block = leading(mode.A.fractions())
            yield f"in free motion, mode {mode.name}", self._flow(block, b[:-1], inner)
        pulls = self.system.contact.pulls if self.system.contact is not None else ()
        pairs = product(flying, pulls)
        for ((mode, b), q), multiplier in zip(pairs, self.multipliers, strict=True):
            form = self._flow(mode.A.fractions(), b, self.Q)
            crossing = [multiplier * entry for entry in (*q.fractions()[0], Fraction(0))]
            where = f"while the environment lags, mode {mode.name}"
            yield where, with_crossing(form, len(self.Q) - 1, crossing)

    def _in_discrete_time(self, touching: Moves, flying: Moves) -> Iterator[tuple[str, Rows]]:
        inner, last = leading(self.Q), len(self.Q) - 1
        for mode, b in touching:
            A = mode.A.fractions()
            yield f"in mode {mode.name}", self._step(self.Q, A, b, self.Q)
            if not self.multipliers:
                continue
            form = self._step(self.Q, A[:-1], b[:-1], inner)
            crossing = [self.multipliers[0] * entry for entry in (*A[-1], b[-1])]
            where = f"where contact is lost in mode {mode.name}"
            yield where, with_crossing(form, last, crossing)
        for mode, b in flying:
            A = [row[:-1] for row in mode.A.fractions()]
            kept = self._step(inner, A[:-1], b[:-1], inner)
            yield f"in free motion, mode {mode.name}", kept
            made = self._step(inner, A, b, self.Q)
            yield f"where contact is made, mode {mode.name}", made

    def _flow(self, A: Rows, b: Sequence[Fraction], Q: Rows) -> Rows:
        """Return ``[[-(A'Q + QA + a Q), -QB], [., a/bound^2]]``."""
        moved = multiply(Q, [[*row, entry] for row, entry in zip(A, b, strict=True)])
        n = len(Q)
        form = [
            [-moved[i][j] - moved[j][i] - self.share * Q[i][j] for j in range(n)] for i in range(n)
        ]
        border = [-moved[i][n] for i in range(n)]
        return _bordered(form, border, self.share / self.channel.bound**2)

    def _step(self, before: Rows, A: Rows, b: Sequence[Fraction], after: Rows) -> Rows:
        """Return ``[[(1 - a) before, 0], [0, a/bound^2]] - [A, B]' after [A, B]``."""
        rows = [[*row, entry] for row, entry in zip(A, b, strict=True)]
        kept = [[(1 - self.share) * entry for entry in row] for row in before]
        zeros = [Fraction(0)] * len(before)
        whole = _bordered(kept, zeros, self.share / self.channel.bound**2)
        image = multiply(list(zip(*rows, strict=True)), multiply(after, rows))
        return [
            [a - b for a, b in zip(left, right, strict=True)]
            for left, right in zip(whole, image, strict=True)
        ]


def _bordered(M: Rows, border: Sequence[Fraction], corner: Fraction) -> Rows:
    return [*([*row, entry] for row, entry in zip(M, border, strict=True)), [*border, corner]]
