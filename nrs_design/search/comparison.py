"""The gradient iteration beside the LMI: one run of each, on the same system."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product

from nrs_design.errors import DesignError
from nrs_design.progress import Progress, silent
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.search.method import Method
from nrs_design.search.method_run import MethodRun

Decide = Callable[[Method, Limits], Certification]


def compare_methods(
    decide: Decide, limits: Limits, progress: Progress = silent
) -> tuple[MethodRun, ...]:
    """Run the LMI once, and the iteration in all coordinates and orders.

    A `DesignError` if the methods do not apply to the system, or there is no mode to start with.
    """
    progress("lmi")
    try:
        known = decide(Method.LMI, replace(limits, gradient=Gradient()))
    except DesignError as error:
        raise DesignError(
            "LMI and gradient iteration look for one quadratic function for all modes, which does "
            "not apply to this kind of switching",
            remedy="use `nrs-design certify-switching`",
        ) from error
    runs = [MethodRun(Method.LMI, known, _seconds(known))]
    for coordinates, order in product(Coordinates, Order):
        progress(f"gradient, {coordinates}, {order}")
        runs.append(_run_gradient(decide, limits, coordinates, order))
    return tuple(runs)


def _run_gradient(
    decide: Decide, limits: Limits, coordinates: Coordinates, order: Order
) -> MethodRun:
    histories: list[list[tuple[int, float]]] = []

    def tell(updates: int, largest: float) -> None:
        if not updates:
            histories.append([])
        histories[-1].append((updates, largest))

    gradient = replace(limits.gradient, coordinates=coordinates, order=order, tell=tell)
    found = decide(Method.GRADIENT, replace(limits, gradient=gradient))
    told = tuple(map(tuple, histories))
    return MethodRun(Method.GRADIENT, found, _seconds(found), coordinates, order, told)


def _seconds(found: Certification) -> float:
    return sum(attempt.seconds for attempt in found.attempts)
