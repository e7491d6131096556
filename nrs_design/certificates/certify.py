"""Decide the stability of a switched system: search, round, check exactly, report honestly."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from time import perf_counter

from numpy.linalg import LinAlgError

from nrs_design.certificates.certificate import CommonQuadratic, Evidence
from nrs_design.certificates.second_opinion import confirm
from nrs_design.certificates.steps import (
    Family,
    Finding,
    Step,
    examine_every_mode,
    examine_suspicious_modes,
    floats_in_silence,
    search_by_gradient,
    search_by_lmi,
)
from nrs_design.errors import DesignError
from nrs_design.switched.system import SwitchedSystem, Time

Progress = Callable[[str], None]


class Verdict(StrEnum):
    """What is known about uniform exponential stability under the declared switching."""

    PROVED = "proved"
    REFUTED = "refuted"
    INCONCLUSIVE = "inconclusive"


class CommonQuadraticStatus(StrEnum):
    """What is known about a common quadratic Lyapunov function."""

    EXISTS = "exists"
    IMPOSSIBLE = "impossible"
    UNKNOWN = "unknown"


class Method(StrEnum):
    """Which search looks for the common quadratic function."""

    AUTO = "auto"
    LMI = "lmi"
    GRADIENT = "gradient"


@dataclass(frozen=True, slots=True)
class Attempt:
    """One step of the search: what was tried, how it ended, and its time in s."""

    step: str
    outcome: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Certification:
    """The verdict on one system, with its evidence (None if inconclusive).

    Parameters
    ----------
    system : SwitchedSystem
        What the verdict is about.
    verdict : Verdict
        Proved, refuted or inconclusive.
    common_quadratic : CommonQuadraticStatus
        Whether a common quadratic function exists.
    method : str
        The step that settled it, or the last one tried.
    evidence : Evidence or None
        Checked in exact arithmetic.
    attempts : tuple of Attempt
        Every step in order.
    """

    system: SwitchedSystem
    verdict: Verdict
    common_quadratic: CommonQuadraticStatus
    method: str
    evidence: Evidence | None
    attempts: tuple[Attempt, ...]


def certify(
    system: SwitchedSystem,
    method: Method = Method.AUTO,
    *,
    optimize_rate: bool = True,
    progress: Progress = lambda step: None,
) -> Certification:
    """Prove or refute uniform exponential stability under arbitrary switching.

    Parameters
    ----------
    system : SwitchedSystem
        Exact modes.
    method : Method
        Semidefinite programming, the gradient iteration, or one after the other.
    optimize_rate : bool
        Look for the largest provable decay rate, not only for some.
    progress : callable
        Told the name of each step as it begins.

    Returns
    -------
    Certification
        Any evidence in it has passed the exact check and flint's second opinion.

    Raises
    ------
    DesignError
        If the gradient iteration is asked for in discrete time, where it is not defined.
    InternalError
        If two exact computations disagree.
    """
    if method is Method.GRADIENT and system.time is Time.DISCRETE:
        raise DesignError(
            "the gradient iteration is for continuous time", remedy="use --method lmi"
        )
    with floats_in_silence():
        family = Family.of(system)
    attempts: list[Attempt] = []
    for name, step in _steps(method, optimize_rate, system.time):
        progress(name)
        start = perf_counter()
        evidence, outcome = _take(step, family)
        attempts.append(Attempt(name, outcome, perf_counter() - start))
        if evidence is not None:
            confirm(system, evidence)
            return _settled(system, name, evidence, tuple(attempts))
    return Certification(
        system,
        Verdict.INCONCLUSIVE,
        CommonQuadraticStatus.UNKNOWN,
        str(method),
        None,
        tuple(attempts),
    )


def _steps(method: Method, optimize_rate: bool, time: Time) -> list[tuple[str, Step]]:
    """List the steps, cheapest first; the exact test of every mode only if no proof was found."""
    steps: list[tuple[str, Step]] = [("suspicious modes", examine_suspicious_modes)]
    if method is not Method.GRADIENT:
        steps.append(("lmi", partial(search_by_lmi, optimize_rate=optimize_rate)))
    if method is not Method.LMI and time is Time.CONTINUOUS:
        steps.append(("gradient", search_by_gradient))
    return [*steps, ("every mode", examine_every_mode)]


def _take(step: Step, family: Family) -> Finding:
    """Take one step; where floating point fails, nothing is found."""
    try:
        with floats_in_silence():
            return step(family)
    except (LinAlgError, OverflowError) as error:
        return None, f"floating point failed ({error})"


def _settled(
    system: SwitchedSystem, step: str, evidence: Evidence, attempts: tuple[Attempt, ...]
) -> Certification:
    if isinstance(evidence, CommonQuadratic):
        verdict, status = Verdict.PROVED, CommonQuadraticStatus.EXISTS
    else:
        # A common quadratic function would make every mode stable.
        verdict, status = Verdict.REFUTED, CommonQuadraticStatus.IMPOSSIBLE
    return Certification(system, verdict, status, step, evidence, attempts)
