"""The exact verdict on a quadratic function that anybody proposes.

``V(x) = x' P x`` decreases in every mode iff P and the decreases ``-(A'P + PA)`` (discrete time:
``P - A'PA``) are positive definite. Where one is not, elimination itself yields a vector that shows
it: the test is a proof in either direction, and no eigenvalue is computed. Definiteness is decided
by `nrs_design.proof.exact`, as for certificates.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq, fmpq_mat

from nrs_design.api.result import AbstractResult
from nrs_design.proof.exact import (
    MAX_WORK,
    TooLargeError,
    bit_length,
    is_positive_definite,
    is_positive_semidefinite,
)
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# Bisection steps for the rate: each step halves the interval of the rate.
RATE_BITS = 20
# How many decisions about all modes that takes, nearly.
DECISIONS = 2 * RATE_BITS
# A counterexample is written with as few of these decimal digits as show it.
DIGITS = (1, 2, 4, 8, 16)
# Characters of an exact number in text; longer numbers are rounded for display.
LONGEST = 60
_LAW = {"continuous": "x' = A x", "discrete": "x+ = A x"}
# Form that must be negative, by time and presence of a rate.
_CHANGE = {
    ("continuous", False): "x' (A'P + PA) x",
    ("continuous", True): "x' (A'P + PA + 2 alpha P) x",
    ("discrete", False): "x' (A'PA - P) x",
    ("discrete", True): "x' (A'PA - rho^2 P) x",
}


@dataclass(frozen=True, slots=True)
class Counterexample:
    """A vector at which a condition on the function fails."""

    # Mode in which V does not decrease; None if P is not positive definite.
    mode: str | None
    vector: tuple[Fraction, ...]  # A nonzero x, exactly
    # If `mode` is None: ``x' P x``, not positive. Otherwise: ``x' (A'P + PA + 2 alpha P) x`` of the
    # mode at the requested rate (discrete time: ``x' (A'PA - rho^2 P) x``), not negative.
    value: Fraction


@dataclass(frozen=True, repr=False)
class LyapunovCheck(AbstractResult):
    """What a quadratic function shows about a family of modes, decided exactly."""

    # P is positive definite, and V decreases strictly in every mode at the requested rate.
    holds: bool
    # P is positive definite, and V increases in no mode: stability, but no decay, is shown.
    weak: bool
    # A proved rate of V: alpha in 1/s, or rho per step in discrete time. It is the requested rate
    # if V holds at it, else the best rate of a bisection, rounded conservatively. None if V does
    # not decrease strictly, or if the numbers are too large for a bisection.
    rate: Fraction | None
    counterexample: Counterexample | None  # Reason for failure
    # modes, form, time: the input. asked: the requested rate; None requests no specific rate.
    modes: tuple[Mode, ...]
    form: RationalMatrix
    time: Time
    asked: Fraction | None = None

    @property
    def P(self) -> NDArray[np.float64]:
        """The matrix of the function, shape (n, n), rounded to doubles."""
        import numpy as np

        return np.array(self.form.fractions(), dtype=float)

    def _facts(self) -> dict[str, Any]:
        failing = self.counterexample
        return {
            "time": str(self.time),
            "modes": [mode.name for mode in self.modes],
            "holds": self.holds,
            "weak": self.weak,
            "rate_asked": None if self.asked is None else str(self.asked),
            "rate": None if self.rate is None else str(self.rate),
            "counterexample": failing
            and {
                "mode": failing.mode,
                "vector": [str(entry) for entry in failing.vector],
                "value": str(failing.value),
            },
        }

    def _headline(self) -> str:
        rate_note = "" if self.asked is None else " at the rate asked for"
        return f"x' P x {'holds' if self.holds else 'does not hold'}{rate_note}"

    def lines(self) -> Iterator[str]:
        """Yield the decision and its reason in words."""
        from nrs_design.proof.evidence.fields import rate_words

        is_requested, law = self.asked is not None, _LAW[self.time]
        best = None if self.rate is None else rate_words(self.rate, self.time)
        if self.holds:
            yield (
                f"HOLDS: x' P x is positive definite and, along {law}, decreases strictly in every "
                f"mode: {', '.join(mode.name for mode in self.modes)}"
            )
            if best is None:
                yield "the numbers are too large to look for its rate: ask for one"
            else:
                yield f"{'the rate asked for' if is_requested else 'proved'}: {best}"
            return
        too_slowly = " at this rate" * is_requested
        yield f"DOES NOT HOLD: x' P x is not a common Lyapunov function{too_slowly}"
        if (failing := self.counterexample) is not None:
            value, *vector = map(_format_number, (failing.value, *failing.vector))
            if failing.mode is None:
                yield f"P is not positive definite: x' P x = {value}"
            else:
                yield f"in mode {failing.mode} it does not decrease{too_slowly}:"
                yield f"{_CHANGE[self.time, is_requested]} = {value}, which is not below zero,"
            yield f"at x = ({', '.join(vector)})"
        if best is not None:
            yield f"along {law} it decreases strictly in every mode, proved at {best} only"
        elif self.weak:
            yield "it increases in no mode, which shows stability but no decay"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "", ""
        yield from (("", line) for line in self.lines())

    def __bool__(self) -> bool:
        """Return True if the function holds at the requested rate."""
        return self.holds


def check_quadratic(
    modes: Sequence[Mode], P: RationalMatrix, time: Time, rate: Fraction | None = None
) -> LyapunovCheck:
    """Decide whether ``x' P x``, with a symmetric P, is a common Lyapunov function of all modes.

    It is decided at a rate, alpha in 1/s or rho per step; without one, at any rate of decay, and
    the best one is looked for. A ValueError without a mode, for other sizes, or a rate that is not
    one of decay; a `TooLargeError` if it would take more than some seconds.
    """
    n = len(P.numerators)
    if not modes:
        raise ValueError("there is no mode")
    if any(mode.A.shape != (n, n) for mode in modes) or P.shape != (n, n):
        raise ValueError(f"P is {n} x {P.shape[1]}, and not every mode is {n} x {n}")
    still = Fraction(int(time is Time.DISCRETE))
    if rate is not None and (rate < 0 or (time is Time.DISCRETE and not 0 < rate <= 1)):
        raise ValueError("a rate of decay is not negative, and in discrete time in (0, 1]")
    requested = still if rate is None else rate
    work = _work(modes, P, time, requested)
    if work > MAX_WORK // 2:
        raise TooLargeError("the matrices are too large, or their numbers too long, to decide")
    affordable = DECISIONS * work <= 4 * MAX_WORK
    for mode, form in _forms(modes, P, time, requested):
        if not is_positive_definite(_integers(form)):
            first, *others = (_integers(M) for _, M in _forms(modes, P, time, still))
            positive = is_positive_definite(first)
            weak = positive and all(map(is_positive_semidefinite, others))
            decays = positive and all(map(is_positive_definite, others))
            best = _best_rate(modes, P, time) if affordable and decays else None
            failing = _counterexample(mode, form)
            return LyapunovCheck(False, weak, best, failing, tuple(modes), P, time, rate)
    best = _best_rate(modes, P, time) if rate is None and affordable else rate
    return LyapunovCheck(True, True, best, None, tuple(modes), P, time, rate)


def _work(modes: Sequence[Mode], P: RationalMatrix, time: Time, rate: Fraction) -> int:
    """Predict what one decision about P and all modes takes; see `MAX_WORK`."""
    longest = max(
        max(bit_length(mode.A.numerators), mode.A.denominator.bit_length()) for mode in modes
    )
    long = max(rate.numerator.bit_length(), rate.denominator.bit_length())
    n = len(P.numerators)
    times = 1 if time is Time.CONTINUOUS else 2
    bits = times * (longest + long + n.bit_length()) + bit_length(P.numerators)
    return (len(modes) + 1) * n**3 * bits


def _forms(
    modes: Sequence[Mode], P: RationalMatrix, time: Time, rate: Fraction
) -> Iterator[tuple[Mode | None, fmpq_mat]]:
    """Yield P, and the decrease in every mode: what must be positive definite."""
    form = _rational(P)
    yield None, form
    for mode in modes:
        yield mode, decrease(_rational(mode.A), form, rate, time)


def decrease(A: fmpq_mat, P: fmpq_mat, rate: Fraction, time: Time) -> fmpq_mat:
    """Return ``-(A'P + PA + 2 rate P)``, or ``rate^2 P - A'PA`` per step; P is symmetric."""
    factor = fmpq(rate.numerator, rate.denominator)
    if time is Time.CONTINUOUS:
        half = -(P * A) - P * factor
        return half + half.transpose()
    return P * (factor * factor) - A.transpose() * P * A


def _rational(M: RationalMatrix) -> fmpq_mat:
    columns = len(M.numerators[0])
    flat = [fmpq(entry, M.denominator) for row in M.numerators for entry in row]
    return fmpq_mat(len(M.numerators), columns, flat)


def _integers(M: fmpq_mat) -> list[list[int]]:
    """Return a matrix times the positive common denominator of its entries."""
    return [[int(entry) for entry in row] for row in M.numer_denom()[0].table()]


def _best_rate(modes: Sequence[Mode], P: RationalMatrix, time: Time) -> Fraction:
    """Bisect the largest alpha, or ``1 - rho``; the rate that is returned has been decided.

    V decreases strictly in finitely many modes, so halving ends at a rate that is proved.
    """

    def convert_decay(decay: Fraction) -> Fraction:
        return decay if time is Time.CONTINUOUS else 1 - decay

    def is_proved(decay: Fraction) -> bool:
        forms = _forms(modes, P, time, convert_decay(decay))
        return all(is_positive_definite(_integers(form)) for _, form in forms)

    low = _decay_bound(modes, P) if time is Time.CONTINUOUS else Fraction(1, 2)
    while not is_proved(low):
        low /= 2
    high = 2 * low
    for _ in range(RATE_BITS):
        middle = (low + high) / 2
        low, high = (middle, high) if is_proved(middle) else (low, middle)
    return convert_decay(low)


def _decay_bound(modes: Sequence[Mode], P: RationalMatrix) -> Fraction:
    """Return a power of two above half of every provable alpha.

    All are below ``-x'PAx / x'Px`` at one x, here the first unit vector.
    """
    form = _rational(P)
    bound = _fraction((form * _rational(modes[0].A))[0, 0] / form[0, 0])
    return Fraction(2) ** (bound.numerator.bit_length() - bound.denominator.bit_length())


def _counterexample(mode: Mode | None, form: fmpq_mat) -> Counterexample:
    """Return a vector at which a form is not positive, and the value of the condition there."""
    vector = _shorten_vector(indefinite_vector(form), form)
    value = _value(form, vector)
    name, value = (None, value) if mode is None else (mode.name, -value)
    return Counterexample(name, vector, value)


def _shorten_vector(vector: tuple[Fraction, ...], M: fmpq_mat) -> tuple[Fraction, ...]:
    """Return a nearby vector of few digits with the same sign, else the given vector."""
    largest = max(map(abs, vector))
    for digits in DIGITS:
        unit = 10**digits
        short = tuple(Fraction(round(entry / largest * unit), unit) for entry in vector)
        if _value(M, short) <= 0:
            return short
    return vector


def _value(M: fmpq_mat, vector: Sequence[Fraction]) -> Fraction:
    """Return ``x' M x``."""
    x = fmpq_mat(len(vector), 1, [fmpq(v.numerator, v.denominator) for v in vector])
    return _fraction((x.transpose() * M * x)[0, 0])


def _fraction(number: fmpq) -> Fraction:
    return Fraction(int(number.p), int(number.q))


def indefinite_vector(M: fmpq_mat) -> tuple[Fraction, ...]:
    """Return a nonzero x with ``x' M x <= 0`` for a symmetric M that is not positive definite.

    With B the block above and left of an entry of the diagonal, and c the column above it,
    ``x = (-B^-1 c, 1, 0)`` gives the pivot of elimination there as ``x' M x``. The first pivot that
    is not positive is taken; blocks before it are positive definite. A ValueError if M is positive
    definite.
    """
    n = M.nrows()
    for k in range(n):
        head: list[fmpq] = []
        if k:
            block = fmpq_mat(k, k, [M[i, j] for i in range(k) for j in range(k)])
            solution = block.solve(fmpq_mat(k, 1, [-M[i, k] for i in range(k)]))
            head = [solution[i, 0] for i in range(k)]
        vector = (*map(_fraction, head), Fraction(1), *[Fraction(0)] * (n - k - 1))
        if _value(M, vector) <= 0:
            return vector
    raise ValueError("the matrix is positive definite")


def _format_number(number: Fraction) -> str:
    from nrs_design.proof.bounds import nearly

    text = str(number)
    return text if len(text) <= LONGEST else nearly(number)
