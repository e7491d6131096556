"""One quadratic function for all modes and for free motion, while contact comes and goes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any, ClassVar, Self

from nrs_design.proof.contact import Contact
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
    scaled,
)
from nrs_design.proof.matrix import RationalMatrix, leading, with_crossing
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.steps import Steps, find_odd_roundings
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted

Forms = Iterator[tuple[str, IntegerMatrix]]
NO_CONTACT = "the system does not say how contact is lost"


@dataclass(frozen=True, slots=True)
class ConewiseQuadratic(AbstractFunction):
    """``V = w' Q w`` decreases in contact and free, with ``w = (y, max(delta, 0))``.

    V is ``x' Q x`` in contact and ``y' Q_yy y`` free, and continuous where the two meet. In
    continuous time it decreases

    - in contact: ``-(A'Q + QA + 2 alpha Q) > 0`` for every mode;
    - free: the same for the block of y of every free mode and of Q;
    - deflected without force, where an environment could pull: for every free mode F and every
      force q, ``-(F'Q + QF + 2 alpha Q) + lambda (e q + q' e') > 0`` with a lambda >= 0 of its
      own, since there ``delta q x <= 0`` for one q at least (S-procedure).

    In discrete time, with N the rows of y of a map and c that of delta:

    - contact to contact: ``rho^2 Q - A'QA > 0`` for every mode;
    - contact to free: ``rho^2 Q - N' Q_yy N + lambda (e c + c' e') > 0`` with one lambda >= 0 for
      all modes, since there ``delta c x <= 0``. That lambda is one for all makes the condition
      hold for convex combinations of modes;
    - free to free, and free to contact: the depth after landing lies between 0 and ``c y``, V is
      convex in it, so both ends suffice: ``rho^2 Q_yy - N' Q_yy N > 0`` and
      ``rho^2 Q_yy - (N, c)' Q (N, c) > 0`` for every free mode;
    - deflected without force, where an environment could pull, for every free mode and every force
      q: ``rho^2 Q - F'QF + mu (e q + q' e') > 0`` if the deflection stays, and if it does not
      ``rho^2 Q - N' Q_yy N + mu (e q + q' e') + lambda (e c + c' e') > 0``, each mu and this lambda
      one for all free modes.
    """

    kind: ClassVar[str] = "conewise-quadratic"
    bounds_at_once: ClassVar[bool] = True
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True

    Q: Matrix  # Shape (n, n). Numerators of the symmetric matrix.
    denominator_log2: int  # Q is these numerators over two to this power
    rate: Fraction  # The alpha in 1/s, or rho per step
    # The lambdas, over the denominator of Q: in continuous time one for each free mode and each
    # force in turn; in discrete time one, and for each force three more, as in
    # `nrs_design.proof.steps.Steps`.
    multipliers: tuple[int, ...]
    # Over the denominator of Q: the multipliers of `nrs_design.proof.steps.Steps`, if what the
    # arithmetic rounds is covered.
    roundings: tuple[int, ...] = ()

    @property
    def covers_rounding(self) -> bool:
        """Whether it has the multipliers for it."""
        return bool(self.roundings)

    @property
    def is_common_quadratic(self) -> bool:
        """True: in contact it is one for all modes."""
        return True

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the level sets of V are convex in contact, and free."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that contact can be lost, shapes, and the signs of rate and multipliers."""
        if system.contact is None:
            return NO_CONTACT
        if not is_square(self.Q, system.order):
            return f"Q is not a {system.order} x {system.order} matrix"
        if (odd := find_odd_multipliers(self.multipliers, system)) is not None:
            return odd
        if (odd := find_odd_roundings(self.roundings, system)) is not None:
            return odd
        return self.find_rate_misfit(system.time)

    def forms(self, system: SwitchedSystem) -> Forms:
        """Yield Q and the decreases in contact, free, and between the two."""
        assert system.contact is not None  # find_misfit
        yield "Q is not symmetric and positive definite", self.Q
        if system.time is Time.CONTINUOUS:
            yield from self._in_continuous_time(system.modes, system.contact)
            return
        crossing, *lagging = self.multipliers
        steps = Steps(
            self.Q,
            self.denominator_log2,
            self.rate**2,
            crossing,
            self.roundings,
            lagging=in_threes(lagging),
        )
        for where, form in steps.forms(system):
            yield _failure(where), form

    def _in_continuous_time(self, modes: tuple[Mode, ...], contact: Contact) -> Forms:
        for mode in modes:
            yield _failure(f"in mode {mode.name}"), self._decrease(mode.A)
        for mode in contact.free:
            free, Q = _block(mode.A), leading(self.Q)
            form = lyapunov_decrease(free.numerators, free.denominator, Q, self.rate)
            yield _failure(f"in free motion, mode {mode.name}"), form
        pairs = product(contact.free, contact.pulls)
        for (mode, q), multiplier in zip(pairs, self.multipliers, strict=True):
            factor = multiplier * lyapunov_factor(mode.A.denominator, self.rate)
            form = with_crossing(
                scaled(self._decrease(mode.A), q.denominator),
                len(self.Q) - 1,
                [factor * entry for entry in q.numerators[0]],
            )
            yield _failure(f"while the environment lags, mode {mode.name}"), form

    def _decrease(self, A: RationalMatrix) -> list[list[int]]:
        return lyapunov_decrease(A.numerators, A.denominator, self.Q, self.rate)

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution, with contact or without."""
        assert system.contact is not None  # find_misfit
        continuous = system.time is Time.CONTINUOUS
        bound = "exp(-alpha t) |w(0)|" if continuous else "rho^t |w(0)|"
        modes, free = len(system.modes), len(system.contact.free)
        return (
            "Every solution, with contact lost and made again at any time and switching "
            f"arbitrarily among {counted(modes, 'mode')} in contact and {counted(free, 'mode')} of "
            f"free motion, satisfies |w(t)| <= {bound} with {rate_words(self.rate, system.time)}, "
            "where w holds the states other than the deflection, and the deflection where it is "
            "positive, in the norm |w| = sqrt(w' Q w). Where free motion ends is not claimed."
        )

    def to_fields(self) -> dict[str, Any]:
        """Return Q, the rate and the multipliers."""
        return {
            "Q": matrix_fields(self.Q, self.denominator_log2),
            "rate": str(self.rate),
            "multipliers": list(self.multipliers),
            **rounding_fields(self.roundings),
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read Q, the rate and the multipliers; they say nothing where no contact can be lost."""
        if system.contact is None:
            raise ValueError(NO_CONTACT)
        Q, denominator_log2 = read_dyadic(fields["Q"])
        multipliers = tuple(read_integer(entry) for entry in fields["multipliers"])
        rate = read_ratio(fields["rate"])
        return cls(Q, denominator_log2, rate, multipliers, read_roundings(fields))


def multiplier_count(contact: Contact, time: Time) -> int:
    """Return how many multipliers the conditions need."""
    if time is Time.CONTINUOUS:
        return len(contact.free) * len(contact.pulls)
    return 1 + 3 * len(contact.pulls)


def find_odd_multipliers(multipliers: Sequence[int], system: SwitchedSystem) -> str | None:
    """TRUSTED: say why multipliers do not belong to the lost contact of a system, or None.

    There are none where contact is kept.
    """
    contact = system.contact
    needed = 0 if contact is None else multiplier_count(contact, system.time)
    if len(multipliers) != needed:
        return "there is not one multiplier for each condition that needs it"
    return "a multiplier is negative" if any(entry < 0 for entry in multipliers) else None


def in_threes(multipliers: Sequence[int]) -> tuple[tuple[int, int, int], ...]:
    """Return those of each force that could pull, as `Steps` takes them; all but the first."""
    return tuple(zip(multipliers[::3], multipliers[1::3], multipliers[2::3], strict=True))


def _failure(where: str) -> str:
    return f"V does not decrease at the claimed rate {where}"


def _block(A: RationalMatrix) -> RationalMatrix:
    """Return the rows and columns of all states but the last."""
    return RationalMatrix(tuple(leading(A.numerators)), A.denominator)
