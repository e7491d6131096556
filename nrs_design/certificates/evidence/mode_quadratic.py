"""One quadratic function per mode, for dwell times, transition graphs and resets."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.certificates.evidence.abstract import AbstractEvidence, Shows
from nrs_design.certificates.evidence.common_quadratic import find_rate_misfit, is_square
from nrs_design.certificates.evidence.fields import (
    Matrix,
    matrix_fields,
    rate_words,
    read_matrix,
    read_ratio,
    read_text,
)
from nrs_design.certificates.exact import (
    MAX_WORK,
    IntegerMatrix,
    add,
    congruence,
    is_positive_semidefinite,
    is_symmetric,
    is_too_large,
    lyapunov_decrease,
    stein_decrease,
)
from nrs_design.spec.bounds import rounded_up
from nrs_design.switched.matrix import RationalMatrix, multiply
from nrs_design.switched.system import Mode, SwitchedSystem, Switching, Time

PRECISION = 300
MIDPOINT_BITS = 160
MAX_DWELL_STEPS = 4096
MAX_POWER_BITS = 10**6
# Balls beyond this fail; what is nearer to zero than its inverse counts as zero with that radius.
RANGE_LOG2 = 32_768


@dataclass(frozen=True, slots=True)
class ModeQuadratic(AbstractEvidence):
    """``V_i(x) = x' Q_i x`` decreases in mode i, and no switch raises the function.

    With ``B_i = A_i + alpha I`` and the shortest dwell time T, for every transition from i to j
    with reset map G: ``exp(B_i T)' G' Q_j G exp(B_i T) <= Q_i`` (Geromel and Colaneri 2006, for
    T > 0; thesis 5.13, for T = 0). In discrete time ``A_i / rho`` and its T-th power.

    Parameters
    ----------
    functions : tuple of (str, matrix)
        Mode names and the integer numerators of their Q_i, in the order of the modes.
    denominator_log2 : int
        All Q_i are these numerators over two to this power.
    rate : Fraction
        alpha in 1/s, or rho per step.
    """

    kind: ClassVar[str] = "mode-quadratic"
    allows_unequal_modes: ClassVar[bool] = True

    functions: tuple[tuple[str, Matrix], ...]
    denominator_log2: int
    rate: Fraction

    @property
    def shows(self) -> Shows:
        """Stability."""
        return Shows.STABILITY

    def fits(self, switching: Switching) -> bool:
        """Tell whether every mode in force is one of the modes, and every reset is unambiguous.

        A constant parameter is anywhere between its ends, where a function for each end says
        nothing about it.
        """
        switches = {(reset.source, reset.target) for reset in switching.resets}
        unambiguous = len(switches) == len(switching.resets) and all(a != b for a, b in switches)
        return unambiguous and not switching.fixed_ends

    def proved_rate(self, system: SwitchedSystem) -> Fraction:
        """Return the claimed rate."""
        return self.rate

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check shapes, rate and, where time is free or discrete, the switches."""
        if [name for name, _ in self.functions] != [mode.name for mode in system.modes]:
            return "there is not one function for each mode"
        for mode, (_, Q) in zip(system.modes, self.functions, strict=True):
            if not is_square(Q, mode.A.shape[0]):
                return f"Q of mode {mode.name} has the wrong size"
        for source, target in system.transitions():
            if _reset_shape(system, source, target) != (target.A.shape[0], source.A.shape[0]):
                return f"the switch from {source.name} to {target.name} has no fitting reset"
        if _dwell(system) > MAX_DWELL_STEPS:
            return "the dwell time is too long"
        if system.time is Time.DISCRETE and _dwell(system).denominator != 1:
            return "the dwell time is not a whole number of steps"
        if misfit := find_rate_misfit(self.rate, system.time):
            return misfit
        if system.time is Time.DISCRETE and _power_is_too_large(system, self.rate):
            return "the dwell time is too long for such large numbers"
        return None if _dwell(system) > 0 else self._find_raising_switch(system)

    def _find_raising_switch(self, system: SwitchedSystem) -> str | None:
        """Check the switches that may follow each other at once: exact, equality allowed."""
        Q = dict(self.functions)
        for source, target in system.transitions():
            jump = _jump(system, source, target, Q)
            if is_too_large(jump):
                return f"the numbers at the switch from {source.name} are too large to check"
            if not is_symmetric(jump) or not is_positive_semidefinite(jump):
                return f"the switch from {source.name} to {target.name} raises the function"
        return None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield every Q_i, its decrease, and the switches after a dwell time."""
        form = lyapunov_decrease if system.time is Time.CONTINUOUS else stein_decrease
        Q = dict(self.functions)
        for mode in system.modes:
            A = mode.A
            yield f"Q of mode {mode.name} is not symmetric and positive definite", Q[mode.name]
            failure = f"V does not decrease at the claimed rate in mode {mode.name}"
            yield failure, form(A.numerators, A.denominator, Q[mode.name], self.rate)
        if _dwell(system) > 0:
            for source, target in system.transitions():
                failure = (
                    f"after the dwell time, {source.name} to {target.name} raises the function"
                )
                yield failure, self._dwell_form(system, source, target, Q)

    def _dwell_form(
        self, system: SwitchedSystem, source: Mode, target: Mode, Q: Mapping[str, Matrix]
    ) -> IntegerMatrix:
        """Return a matrix whose positive definiteness shows that a late switch does not raise V."""
        if system.time is Time.DISCRETE:
            steps = int(_dwell(system))
            flow = _power(source.A, steps)
            scale = self.rate ** (2 * steps)
            jump = _image(system, source, target, flow)
            image, square = congruence(jump.numerators, Q[target.name]), jump.denominator**2
            left = scale.numerator * square
            return add(
                [[left * q for q in row] for row in Q[source.name]], image, -scale.denominator
            )
        return _enclosed_form(system, source, target, Q, self.rate)

    def claim(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        continuous = system.time is Time.CONTINUOUS
        law, bound = ("x' = A x", "exp(-alpha t)") if continuous else ("x+ = A x", "rho^t")
        return (
            f"Every solution of {law} under the declared switching ({describe(system)}) satisfies "
            f"|x(t)| <= c {bound} |x(0)| with {rate_words(self.rate, system.time)} and some "
            "constant c that is the same for all signals."
        )

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> Self:
        """Repeat the function of every mode for its equals, between which nothing changes."""
        forms = {mode.A: Q for mode, (_, Q) in zip(merged.modes, self.functions, strict=True)}
        return replace(self, functions=tuple((mode.name, forms[mode.A]) for mode in system.modes))

    def to_fields(self) -> dict[str, Any]:
        """Return the functions and the rate."""
        return {
            "functions": [
                {"mode": name, "Q": matrix_fields(Q, self.denominator_log2)}
                for name, Q in self.functions
            ],
            "rate": str(self.rate),
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the functions and the rate."""
        functions, exponents = [], set()
        for item in fields["functions"]:
            Q, exponent = read_matrix(item["Q"])
            functions.append((read_text(item["mode"]), Q))
            exponents.add(exponent)
        if len(exponents) != 1:
            raise ValueError("the functions do not share one denominator")
        return cls(tuple(functions), exponents.pop(), read_ratio(fields["rate"]))


def describe(system: SwitchedSystem) -> str:
    """Say which switching signals a system has."""
    switching = system.switching
    unit = "s" if system.time is Time.CONTINUOUS else "steps"
    parts = []
    if switching.dwell_time > 0:
        parts.append(f"at least {rounded_up(switching.dwell_time, unit)} in each mode")
    if switching.transitions is not None:
        parts.append(f"{len(switching.transitions)} allowed transitions")
    if switching.resets:
        parts.append(f"{len(switching.resets)} resets")
    return ", ".join(parts) or "arbitrary"


def _dwell(system: SwitchedSystem) -> Fraction:
    """Return the shortest time in a mode; in discrete time at least one step."""
    if system.time is Time.DISCRETE:
        return max(system.switching.dwell_time, Fraction(1))
    return system.switching.dwell_time


def _reset_shape(system: SwitchedSystem, source: Mode, target: Mode) -> tuple[int, int]:
    reset = system.reset_map(source, target)
    return (source.A.shape[0], source.A.shape[0]) if reset is None else reset.shape


def _jump(
    system: SwitchedSystem, source: Mode, target: Mode, Q: Mapping[str, Matrix]
) -> IntegerMatrix:
    """Return a positive multiple of ``Q_i - G' Q_j G``."""
    reset = system.reset_map(source, target)
    if reset is None:
        return add(Q[source.name], Q[target.name], -1)
    left = [[reset.denominator**2 * entry for entry in row] for row in Q[source.name]]
    return add(left, congruence(reset.numerators, Q[target.name]), -1)


def _image(
    system: SwitchedSystem, source: Mode, target: Mode, flow: RationalMatrix
) -> RationalMatrix:
    reset = system.reset_map(source, target)
    if reset is None:
        return flow
    return RationalMatrix.from_rows(multiply(reset.fractions(), flow.fractions()))


def _power_is_too_large(system: SwitchedSystem, rate: Fraction) -> bool:
    numbers = [v for mode in system.modes for row in mode.A.numerators for v in row]
    numbers += [mode.A.denominator for mode in system.modes]
    bits = max(abs(v).bit_length() for v in (*numbers, rate.denominator))
    power_bits = int(_dwell(system)) * bits
    return power_bits > MAX_POWER_BITS or system.order**3 * power_bits > MAX_WORK


def _power(A: RationalMatrix, exponent: int) -> RationalMatrix:
    n = A.shape[0]
    result = RationalMatrix.from_rows([[int(i == j) for j in range(n)] for i in range(n)])
    for bit in bin(exponent)[2:]:
        result = RationalMatrix.from_rows(multiply(result.fractions(), result.fractions()))
        if bit == "1":
            result = RationalMatrix.from_rows(multiply(A.fractions(), result.fractions()))
    return result


def _enclosed_form(
    system: SwitchedSystem, source: Mode, target: Mode, Q: Mapping[str, Matrix], rate: Fraction
) -> IntegerMatrix:
    """Return integers below the true form times a positive number.

    The form ``Q_i - E' Q_j E`` with ``E = G exp(B T)`` is enclosed in balls. If every entry is
    within r of a rational midpoint, then its smallest eigenvalue is at least that of the midpoint
    minus n r, so that much is subtracted from the diagonal.
    """
    from flint import arb_mat, ctx, fmpq, fmpq_mat, fmpz_mat

    before, ctx.prec = ctx.prec, PRECISION
    try:
        A, T = source.A, system.switching.dwell_time
        n = A.shape[0]
        shifted = [
            [Fraction(v, A.denominator) + (rate if i == j else 0) for j, v in enumerate(row)]
            for i, row in enumerate(A.numerators)
        ]
        entries = [fmpq((v * T).numerator, (v * T).denominator) for row in shifted for v in row]
        E = arb_mat(fmpq_mat(n, n, entries)).exp()
        reset = system.reset_map(source, target)
        if reset is not None:
            flat = [fmpq(v, reset.denominator) for row in reset.numerators for v in row]
            E = arb_mat(fmpq_mat(*reset.shape, flat)) * E
        Qi, Qj = (arb_mat(fmpz_mat([list(row) for row in Q[m.name]])) for m in (source, target))
        form = Qi - E.transpose() * Qj * E
        return _lower_integers([[form[i, j] for j in range(n)] for i in range(n)])
    finally:
        ctx.prec = before


def _lower_integers(form: list[list[Any]]) -> IntegerMatrix:
    """Return integers that are below a symmetric ball matrix times a power of two."""
    n = len(form)
    if any(not ball.abs_upper() < 2**RANGE_LOG2 for row in form for ball in row):
        return [[0] * n for _ in range(n)]
    mids = [[_fraction(form[i][j].mid()) for j in range(n)] for i in range(n)]
    radius = max(_fraction(form[i][j].rad()) for i in range(n) for j in range(n))
    # Both a midpoint and a radius may have been taken for zero.
    radius += 2 * Fraction(1, 2**RANGE_LOG2)
    # Both triangles enclose the same number: take the upper one, and let the radius cover it.
    scale = 2**MIDPOINT_BITS
    largest = max((abs(v) for row in mids for v in row), default=Fraction(1)) or Fraction(1)
    unit = Fraction(scale) / largest
    slack = n * (radius * unit + 1)
    rounded = [[round(mids[min(i, j)][max(i, j)] * unit) for j in range(n)] for i in range(n)]
    return [[rounded[i][j] - (int(slack) + 1 if i == j else 0) for j in range(n)] for i in range(n)]


def _fraction(ball: Any) -> Fraction:
    """Return an exact ball (of radius zero) as a fraction, or zero for one very near to it."""
    mantissa, exponent = ball.man_exp()
    if int(mantissa).bit_length() + int(exponent) < -RANGE_LOG2:
        return Fraction(0)
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
