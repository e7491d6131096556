"""How far a proof reaches: ranges, delay, period, disturbances, the time between switches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import Result, assemble_spec
from nrs_design.pipeline.design import Designed, placed
from nrs_design.progress import Progress, silent
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Certification, Limits

if TYPE_CHECKING:
    from nrs_design.search.margin import Bracket, CommandMargin, MarginBrackets
    from nrs_design.spec.sampling import SamplingSpec

MARGIN_BUDGET = 10.0


@dataclass(frozen=True, slots=True)
class ProofMargins:
    """Margins of a proof; None without a request."""

    loop: MarginBrackets | None = None  # Margins of delay, period and disturbances
    box: Bracket | None = None  # Margin of the ranges
    dwell: Bracket | None = None  # Margin of the dwell time


def run_proof_margins(
    result: Result,
    limits: Limits,
    progress: Progress = silent,
    *,
    margin: bool,
    shortest_dwell: bool,
) -> ProofMargins:
    """Find the requested margins, without optimizing the decay rate.

    `margin`: those of ranges, delay, period and disturbances; of ranges alone, a spec must have
    some. `shortest_dwell`: that of the time between switches, in continuous time without longest
    dwell times. Else a `DesignError`.
    """
    from nrs_design.search.certify import certify
    from nrs_design.search.margin import find_margin, find_shortest_dwell

    loaded, known = result.loaded, result.certification
    # Before minutes of work.
    if margin and not _has_loop(result):
        _refuse_box(result)
    if shortest_dwell:
        _refuse_dwell(result)
    # Each of many searches needs a proof only, with any decay rate.
    quick = replace(limits, optimize_rate=False, budget=min(limits.budget, MARGIN_BUDGET))
    decide = partial(certify, limits=quick)
    loop = box = dwell = None
    if margin:
        loop = _run_loop(result, quick, progress)
    if margin and loaded.spec.has_ranges:
        # Around the nominal values; the design is kept.
        assemble = partial(assemble_spec, loaded, result.designed)
        box = find_margin(assemble, decide, known, progress)
    if shortest_dwell:
        # Whatever dwell time the spec declares.
        dwell = find_shortest_dwell(known.system, decide, known, progress)
    return ProofMargins(loop, box, dwell)


def _resample(designed: Designed, changes: Mapping[str, object]) -> SwitchedSystem:
    """Return the loop of a design, undisturbed, where it is sampled otherwise."""
    assert designed.spec.sampling is not None
    sampling = designed.spec.sampling.model_copy(update=changes)
    changed = designed.spec.model_copy(update={"sampling": sampling, "disturbances": None})
    return assemble_spec(designed.loaded, replace(designed, spec=changed))


def _refuse_box(result: Result) -> None:
    """Stop where no range is declared."""
    if not result.loaded.spec.has_ranges:
        given = "modes" if result.design is None else "environments"
        with placed(result.loaded):
            raise DesignError(
                "the spec declares no range, so there is no box to stretch",
                remedy="give an environment or a parameter a range",
                at=(given,),
            )


def _run_loop(result: Result, limits: Limits, progress: Progress) -> MarginBrackets | None:
    """Find the margins of delay, period and disturbances; None without these."""
    from nrs_design.search.margin import MarginBrackets

    if result.designed is None or not _has_loop(result):
        return None
    delay = period = None
    if (sampling := result.designed.spec.sampling) is not None:
        known = result.certification
        delay, period = _sampling_margins(result.designed, sampling, known, limits, progress)
    return MarginBrackets(delay, period, _command_margin(result))


def _has_loop(result: Result) -> bool:
    """Tell whether something is sampled, or disturbs."""
    spec = None if result.designed is None else result.designed.spec
    return spec is not None and not (spec.sampling is None and spec.disturbances is None)


def _sampling_margins(
    designed: Designed,
    sampling: SamplingSpec,
    certification: Certification,
    limits: Limits,
    progress: Progress,
) -> tuple[Bracket, Bracket]:
    """Decide the loop at other delays and other periods, without what disturbs it."""
    from nrs_design.search.certify import certify, refuted_at_once
    from nrs_design.search.margin import find_longest_delay, find_longest_period
    from nrs_design.spec.sampling import LONGEST_DELAY

    def assemble_delays(shortest: int, longest: int) -> SwitchedSystem:
        return _resample(designed, {"delay": (shortest, longest)})

    def assemble_period(period: Fraction) -> SwitchedSystem:
        changes = {
            name: replace(given, value=period * given.value / sampling.period.exact)
            for name in ("period", "outer_period")
            if (given := getattr(sampling, name)) is not None
        }
        return _resample(designed, changes)

    quick, refute = partial(certify, limits=limits), partial(refuted_at_once, limits=limits)
    delays = (*sampling.delay, LONGEST_DELAY)
    return (
        find_longest_delay(delays, assemble_delays, quick, refute, certification, progress),
        find_longest_period(sampling.period.exact, assemble_period, quick, certification, progress),
    )


def _command_margin(result: Result) -> CommandMargin | None:
    """Compare the certified bound on the force with the worst run of an adversary."""
    from nrs_design.certificates.bounds import bound_on
    from nrs_design.search.margin import command_margin
    from nrs_design.simulation.worst_case import worst_against

    system = result.certification.system
    found = bound_on(system, result.certification.statements, "force") if system.channels else None
    return None if found is None else command_margin(found, worst_against(system, found).value)


def _refuse_dwell(result: Result) -> None:
    """Refuse specs to which no dwell time applies, by the rule for a spec that declares one."""
    loaded, system = result.loaded, result.certification.system
    if system.time is not Time.CONTINUOUS:
        raise DesignError(
            "a shortest dwell time is for continuous time",
            path=loaded.path,
            remedy="declare a dwell_time, and certify that",
        )
    assert loaded.spec.kind != "robot"  # A robot spec has no modes, hence no certification.
    if obstacle := loaded.spec.find_dwell_obstacle():
        raise DesignError(obstacle.message, path=loaded.path, remedy=obstacle.remedy)
    if len(system.lasting_modes()) < len(system.modes):
        with placed(loaded):
            raise DesignError(
                "a shortest dwell time is not searched beside longest ones",
                remedy="leave longest_dwell_time out, or declare the dwell_time and certify that",
                at=("switching", "longest_dwell_time"),
            )
