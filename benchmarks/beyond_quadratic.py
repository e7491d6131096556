"""How closely the stability limit of the Dayawansa-Martin family is enclosed by proofs."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from time import perf_counter

from benchmarks.families import dayawansa_martin
from benchmarks.measure import Finding, Size
from nrs_design.certificates.certificate import Verdict
from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method

# The true limit is 11.2608; a quadratic function exists below 5.828.
LOW, LIMIT, HIGH = 583, 1126, 1200
HUNDREDTH = Fraction(1, 100)
MAX_DEGREE = 64
BUDGETS, QUICK_BUDGETS, SMOKE_BUDGETS = (1.0, 5.0, 20.0), (1.0,), (0.1,)
WANTED_PROVED, WANTED_REFUTED = 1120, 1127


def run(size: Size) -> tuple[Finding, ...]:
    """Bisect over hundredths, once for each budget of work per certification."""
    return tuple(_enclose(budget) for budget in size.pick(BUDGETS, QUICK_BUDGETS, SMOKE_BUDGETS))


def _enclose(budget: float) -> Finding:
    start = perf_counter()
    limits = Limits(max_degree=MAX_DEGREE, budget=budget, optimize_rate=False)
    proved = _last(LOW, LIMIT + 1, lambda a: _ends(a, Method.POLYNOMIAL, limits, Verdict.PROVED))
    # Counted downward from above, so that the same bisection serves.
    steps = _last(-HIGH, -LIMIT, lambda a: _ends(-a, Method.PERIOD, limits, Verdict.REFUTED))
    refuted = -steps
    return Finding(
        f"Dayawansa-Martin family, {budget:g} units of work per certification",
        f"stable proved up to a = {proved / 100:.2f}, refuted from {refuted / 100:.2f}",
        f"{WANTED_PROVED / 100:.2f} and {WANTED_REFUTED / 100:.2f}",
        proved >= WANTED_PROVED and refuted <= WANTED_REFUTED,
        perf_counter() - start,
    )


def _last(low: int, high: int, holds: Callable[[int], bool]) -> int:
    """Bisect for the last integer that holds, given that `low` does and `high` does not."""
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def _ends(hundredths: int, method: Method, limits: Limits, verdict: Verdict) -> bool:
    """Tell whether a certification within the budget has this verdict."""
    return certify(dayawansa_martin(hundredths * HUNDREDTH), method, limits).verdict is verdict
