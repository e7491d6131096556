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
from math import gcd
from typing import TYPE_CHECKING, Any

from nrs_design.api.result import AbstractResult
from nrs_design.proof.exact import (
    MAX_WORK,
    IntegerMatrix,
    TooLargeError,
    add,
    bit_length,
    congruence,
    is_positive_definite,
    is_positive_semidefinite,
    scaled,
    transpose,
)
from nrs_design.proof.exact import multiply as product
from nrs_design.proof.matrix import RationalMatrix, multiply
from nrs_design.proof.mode import Mode, Time

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# A rate is sharpened to one part in two to this power of the range that it may lie in.
RATE_BITS = 20
# How many decisions about all modes that takes, nearly.
DECISIONS = 2 * RATE_BITS
# A counterexample is written with as few of these decimal digits as show it.
DIGITS = (1, 2, 4, 8, 16)
# A longer number is written rounded in words.
LONGEST = 60
_LAW = {"continuous": "x' = A x", "discrete": "x+ = A x"}
# What must be negative, by time and whether a rate is asked for.
_CHANGE = {
    ("continuous", False): "x' (A'P + PA) x",
    ("continuous", True): "x' (A'P + PA + 2 alpha P) x",
    ("discrete", False): "x' (A'PA - P) x",
    ("discrete", True): "x' (A'PA - rho^2 P) x",
}


@dataclass(frozen=True, slots=True)
class Counterexample:
    """A vector at which a condition on the function fails."""

    # The mode in which the function does not decrease; None if it is not positive.
    mode: str | None
    vector: tuple[Fraction, ...]  # A nonzero x, exactly
    # ``x' P x`` if `mode` is None, which is not positive; otherwise the derivative ``x' (A'P + PA +
    # 2 alpha P) x`` along the mode at the rate that was asked for (discrete time: ``x' (A'PA -
    # rho^2 P) x``), which is not negative.
    value: Fraction


@dataclass(frozen=True, repr=False)
class LyapunovCheck(AbstractResult):
    """What a quadratic function shows about a family of modes, decided exactly."""

    # P is positive definite, and V decreases strictly in every mode at the rate asked for.
    holds: bool
    # P is positive definite, and V increases in no mode: stability, but no decay, is shown.
    weak: bool
    # A rate at which V decreases: alpha in 1/s, or rho per step in discrete time. What was asked
    # for if it holds, or else the best one on a fine grid, rounded to the side that is proved. None
    # if V does not decrease strictly at any rate, or if the numbers are too large to look for one.
    rate: Fraction | None
    counterexample: Counterexample | None  # Why it does not hold
    # modes, form, time, asked: what was decided about, and at which rate; None for any of decay.
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
        asked = "" if self.asked is None else " at the rate asked for"
        return f"x' P x {'holds' if self.holds else 'does not hold'}{asked}"

    def lines(self) -> Iterator[str]:
        """Yield what is decided, and why, in words."""
        from nrs_design.proof.evidence.fields import rate_words

        asked, law = self.asked is not None, _LAW[self.time]
        best = None if self.rate is None else rate_words(self.rate, self.time)
        if self.holds:
            yield (
                f"HOLDS: x' P x is positive definite and, along {law}, decreases strictly in every "
                f"mode: {', '.join(mode.name for mode in self.modes)}"
            )
            if best is None:
                yield "the numbers are too large to look for its rate: ask for one"
            else:
                yield f"{'the rate asked for' if asked else 'proved'}: {best}"
            return
        too_slowly = " at this rate" * asked
        yield f"DOES NOT HOLD: x' P x is not a common Lyapunov function{too_slowly}"
        if (failing := self.counterexample) is not None:
            value, *vector = map(_written, (failing.value, *failing.vector))
            if failing.mode is None:
                yield f"P is not positive definite: x' P x = {value}"
            else:
                yield f"in mode {failing.mode} it does not decrease{too_slowly}:"
                yield f"{_CHANGE[self.time, asked]} = {value}, which is not below zero,"
            yield f"at x = ({', '.join(vector)})"
        if best is not None:
            yield f"along {law} it decreases strictly in every mode, proved at {best} only"
        elif self.weak:
            yield "it increases in no mode, which shows stability but no decay"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "", ""
        yield from (("", line) for line in self.lines())

    def __bool__(self) -> bool:
        """Whether it holds."""
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
    asked = still if rate is None else rate
    work = _work(modes, P, time, asked)
    if work > MAX_WORK // 2:
        raise TooLargeError("the matrices are too large, or their numbers too long, to decide")
    affordable = DECISIONS * work <= 4 * MAX_WORK
    for mode, form in _forms(modes, P, time, asked):
        if not is_positive_definite(form):
            first, *others = (M for _, M in _forms(modes, P, time, still))
            positive = is_positive_definite(first)
            weak = positive and all(map(is_positive_semidefinite, others))
            decays = positive and all(map(is_positive_definite, others))
            best = _best_rate(modes, P, time) if affordable and decays else None
            failing = _counterexample(mode, form, P, asked, time)
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
) -> Iterator[tuple[Mode | None, IntegerMatrix]]:
    """Yield P, and the decrease in every mode: what must be positive definite."""
    yield None, P.numerators
    form = lyapunov_decrease if time is Time.CONTINUOUS else stein_decrease
    for mode in modes:
        yield mode, form(mode.A.numerators, mode.A.denominator, P.numerators, rate)


def lyapunov_decrease(
    N: IntegerMatrix,
    denominator: int,
    Q: IntegerMatrix,
    rate: Fraction,
) -> list[list[int]]:
    """Form ``-(A'Q + QA + 2 rate Q)`` for ``A = N / denominator``, times a positive integer.

    Q is symmetric, the denominator positive, the rate in 1/s.
    """
    QN = product(Q, N)
    p, q = 2 * rate.numerator * denominator, rate.denominator
    common = gcd(p, q)
    p, q = p // common, q // common
    return [
        [-q * (a + b) - p * entry for a, b, entry in zip(*rows, strict=True)]
        for rows in zip(QN, transpose(QN), Q, strict=True)
    ]


def stein_decrease(
    N: IntegerMatrix, denominator: int, Q: IntegerMatrix, factor: Fraction
) -> list[list[int]]:
    """Form ``factor^2 Q - A'QA`` for ``A = N / denominator``, times a positive integer.

    Q is symmetric, the denominator positive, the factor the contraction rho per step.
    """
    p, q = (factor.numerator * denominator) ** 2, factor.denominator**2
    return add(scaled(Q, p), congruence(N, Q), -q)


def _best_rate(modes: Sequence[Mode], P: RationalMatrix, time: Time) -> Fraction:
    """Bisect the largest alpha, or ``1 - rho``; the rate that is returned has been decided.

    V decreases strictly in finitely many modes, so halving ends at a rate that is proved.
    """

    def rate_at(decay: Fraction) -> Fraction:
        return decay if time is Time.CONTINUOUS else 1 - decay

    def is_proved(decay: Fraction) -> bool:
        forms = _forms(modes, P, time, rate_at(decay))
        return all(is_positive_definite(form) for _, form in forms)

    low = _decay_bound(modes, P) if time is Time.CONTINUOUS else Fraction(1, 2)
    while not is_proved(low):
        low /= 2
    high = 2 * low
    for _ in range(RATE_BITS):
        middle = (low + high) / 2
        low, high = (middle, high) if is_proved(middle) else (low, middle)
    return rate_at(low)


def _decay_bound(modes: Sequence[Mode], P: RationalMatrix) -> Fraction:
    """Return a power of two above half of every provable alpha.

    All are below ``-x'PAx / x'Px`` at one x, here the first unit vector.
    """
    Q, A = P.numerators, modes[0].A
    first = sum(Q[0][k] * A.numerators[k][0] for k in range(len(Q)))
    bound = Fraction(first, Q[0][0] * A.denominator)
    return Fraction(2) ** (bound.numerator.bit_length() - bound.denominator.bit_length())


def _counterexample(
    mode: Mode | None, form: IntegerMatrix, P: RationalMatrix, rate: Fraction, time: Time
) -> Counterexample:
    vector = _shortened(indefinite_vector(form), form)
    rows = P.fractions()
    if mode is None:
        return Counterexample(None, vector, _value(rows, vector, vector))
    Ax = [entry for (entry,) in multiply(mode.A.fractions(), [[entry] for entry in vector])]
    if time is Time.CONTINUOUS:
        value = 2 * _value(rows, vector, Ax) + 2 * rate * _value(rows, vector, vector)
    else:
        value = _value(rows, Ax, Ax) - rate**2 * _value(rows, vector, vector)
    return Counterexample(mode.name, vector, value)


def _shortened(vector: tuple[Fraction, ...], M: IntegerMatrix) -> tuple[Fraction, ...]:
    """Return a vector of few digits that shows the same, if there is one near the given."""
    largest = max(map(abs, vector))
    for digits in DIGITS:
        unit = 10**digits
        short = tuple(Fraction(round(entry / largest * unit), unit) for entry in vector)
        if _value(M, short, short) <= 0:
            return short
    return vector


def _value(
    rows: Sequence[Sequence[Fraction | int]], left: Sequence[Fraction], right: Sequence[Fraction]
) -> Fraction:
    """Return ``left' M right``."""
    ((value,),) = multiply([left], multiply(rows, [[entry] for entry in right]))
    return value


def indefinite_vector(M: IntegerMatrix) -> tuple[Fraction, ...]:
    """Return a nonzero x with ``x' M x <= 0`` for a symmetric M that is not positive definite.

    Elimination goes on until a pivot is not positive. With the block above and left of it called
    B, and c the column beside that block, ``x = (-B^-1 c, 1, 0)`` gives that pivot as ``x' M x``
    (here after fraction-free elimination, times the last positive minor). A ValueError if M is
    positive definite.
    """
    rows, minor = [list(row) for row in M], 1
    for k in range(len(rows)):
        pivot = rows[k][k]
        if pivot <= 0:
            return _solved(rows, k, minor)
        for i in range(k + 1, len(rows)):
            first = rows[i][k]
            rows[i] = [
                (pivot * a - first * b) // minor for a, b in zip(rows[i], rows[k], strict=True)
            ]
        minor = pivot
    raise ValueError("the matrix is positive definite")


def _solved(rows: IntegerMatrix, k: int, minor: int) -> tuple[Fraction, ...]:
    """Solve ``U x = -c`` backwards, with the first k rows after elimination.

    By Cramer's rule the solution times the leading minor of order k is integer.
    """
    x = [0] * len(rows)
    x[k] = minor
    for i in reversed(range(k)):
        x[i] = -sum(rows[i][j] * x[j] for j in range(i + 1, k + 1)) // rows[i][i]
    return tuple(Fraction(entry, minor) for entry in x)


def _written(number: Fraction) -> str:
    from nrs_design.proof.bounds import nearly

    text = str(number)
    return text if len(text) <= LONGEST else nearly(number)
