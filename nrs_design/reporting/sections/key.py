"""What a reader wants to know first: with which gains, up to where, with what force."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.axis import unit
from nrs_design.certificates.bounds import bound_on
from nrs_design.design.measures import SENSITIVITY_PEAK
from nrs_design.proof.bounds import lower, upper
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Bullets, Derived, Paragraph, Section
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.register import register_of
from nrs_design.reporting.sections.titles import EVIDENCE, GOALS, MODES
from nrs_design.spec import InteractionDesignSpec

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.certification import Result

TESTS = "What to test on the robot"
# Digits that are read at a glance.
_DIGITS = 4


def key_facts(result: Result, analysis: DesignAnalysis | None) -> tuple[tuple[str, str], ...]:
    """Return labels and values for the head of the page, each on the safe side."""
    return (
        *_worst(analysis),
        *_modes(result),
        *_force(result),
        *_gains(result),
        *_achieved(analysis),
    )


def tests_section(result: Result) -> Section | None:
    """List the open assumptions, each with its test; None where all are tested or argued."""
    found = register_of(result.certification.granted, result.loaded.spec)
    kinds = dict.fromkeys(item.kind for item in found if item.standing == "open")
    tests = tuple(f"{kind.name}: {kind.test}" for kind in kinds if kind.id)
    if not tests:
        return None
    text = f"{len(tests)} kinds of assumptions are neither tested nor argued. Each has a test:"
    return Section(TESTS, (Paragraph(text), Bullets("", tests)))


def _worst(analysis: DesignAnalysis | None) -> Iterator[tuple[str, str]]:
    """Yield what is furthest beyond a limit, and how much else is doubtful."""
    doubts = () if analysis is None else analysis.warnings
    if doubts and doubts[0].beyond:
        more = f" ({counted(len(doubts) - 1, 'more warning')})" if doubts[1:] else ""
        yield "Worst of it", Derived(f"{doubts[0]}{more}", GOALS)


def _modes(result: Result) -> Iterator[tuple[str, str]]:
    if isinstance(result.loaded.spec, InteractionDesignSpec):
        return
    system = result.certification.system
    names = shortened([mode.name for mode in system.modes], 4)
    yield "Modes", Derived(f"{names}; {system.time} time", MODES)


def _force(result: Result) -> Iterator[tuple[str, str]]:
    system = result.certification.system
    spec = result.loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        return
    bound = bound_on(system, result.certification.statements, "force")
    text = "not bounded: no disturbance is declared" if not system.channels else "no bound proved"
    if bound is not None:
        size = f"{upper(bound.level, _DIGITS)} {bound.output.unit}"
        text = f"{size} at most, under the declared disturbances"
    yield "Largest force", Derived(text, EVIDENCE)


def _gains(result: Result) -> Iterator[tuple[str, str]]:
    design = result.design
    if design is None:
        return
    for controller in design.controllers:
        units = design.units.get(controller.name, {})
        said = ", ".join(
            f"{gain} {float(value):.6g} {units.get(gain, '')}".rstrip()
            for gain, value in controller.law.gains.items()
        )
        if said:
            yield f"Gains of {controller.name}", Derived(said, "Designed gains")


def _achieved(analysis: DesignAnalysis | None) -> Iterator[tuple[str, str]]:
    if analysis is None or not analysis.impedance:
        return
    known = [item for item in analysis.impedance if not math.isnan(item.lowest_limit)]
    if known:
        weakest = min(known, key=lambda item: item.lowest_limit)
        arm = weakest.limit_at_arm
        limit, per = (weakest.lowest_limit, unit("N*m/rad")) if arm is None else (arm, "N/m")
        size = "any stiffness" if math.isinf(limit) else f"{lower(Fraction(limit), _DIGITS)} {per}"
        yield "Stands up to", Derived(f"{size} ({weakest.name}; floating point)", GOALS)
    if [*_worst(analysis)]:
        return
    worst = max(analysis.impedance, key=lambda item: item.worst(SENSITIVITY_PEAK).value)
    value = SENSITIVITY_PEAK.text(worst.worst(SENSITIVITY_PEAK).value)
    said = f"sensitivity peak {value} ({worst.name}; usual: {SENSITIVITY_PEAK.usual})"
    yield "Worst margin", Derived(said, GOALS)
