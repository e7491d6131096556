"""Designed gains as floats with units, and their margins."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from nrs_design.api.result import AbstractResult, Figures, section_figures
from nrs_design.models.axis import unit
from nrs_design.pipeline.design import Designed, run_analysis
from nrs_design.proof.bounds import lower_float, upper_float

if TYPE_CHECKING:
    from nrs_design.design.analysis import (
        AbstractControllerAnalysis,
        DesignAnalysis,
        ImpedanceAnalysis,
    )
    from nrs_design.design.goals import Achieved
    from nrs_design.design.measures import Measure


@dataclass(frozen=True, repr=False)
class Optimum(AbstractResult):
    """The design of a spec."""

    designed: Designed  # The spec with its plant and gains

    @property
    def gains(self) -> dict[str, dict[str, float]]:
        """Gains by controller and name; the doubles of the single-precision numbers that ship."""
        controllers = self.designed.design.controllers
        found = {item.name: item.law.gains for item in controllers}
        return {
            name: {gain: float(value) for gain, value in gains.items()}
            for name, gains in found.items()
        }

    @property
    def units(self) -> dict[str, dict[str, str]]:
        """Their units, by the same keys."""
        known = self.designed.design.units
        return {
            name: {gain: known.get(name, {}).get(gain, "") for gain in gains}
            for name, gains in self.gains.items()
        }

    @cached_property
    def analysis(self) -> DesignAnalysis:
        """What the design achieves."""
        return run_analysis(self.designed)

    @property
    def margins(self) -> dict[str, dict[str, float]]:
        """Worst values over the corners of all ranges, by controller and goal, in SI.

        Floating point, not a proof; see `nrs-design explain margins`.
        """
        return {
            item.name: {found.measure.goal: float(found.value) for found in item.achieved}
            for item in self.analysis.measured
        }

    @property
    def cost(self) -> dict[str, float]:
        """The cost of displayed impedance and sensitivity, by impedance controller."""
        return {item.name: float(item.cost) for item in self.analysis.impedance}

    def drawings(self) -> Figures:
        """Return the figures of the design by name."""
        from nrs_design.reporting.sections.design import design_sections

        sections = design_sections(self.designed, self.analysis)
        return section_figures(sections, "displayed-impedance")

    def gain_rows(self) -> Iterator[tuple[str, str, str, str]]:
        """Return controller, gain, value and unit of each gain."""
        for name, gains in self.gains.items():
            for gain, value in gains.items():
                yield name, gain, f"{value:.6g}", self.units[name][gain]

    def _axis(self) -> object:
        return self.designed.spec.axis

    def _facts(self) -> dict[str, Any]:
        analysis = self.analysis
        return {
            **self.designed.loaded.facts,
            "motion_loop": motion_summary(analysis),
            "sensor": _sensor(self.designed),
            "controllers": [_summary(item) for item in analysis.impedance],
            "warnings": [str(doubt) for doubt in analysis.warnings],
        }

    def _drawings(self) -> Figures:
        return self.drawings()

    def _headline(self) -> str:
        return f"{self.designed.spec.name}: designed gains"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "controller", "gain", "value", "unit"
        yield from self.gain_rows()

    def __str__(self) -> str:
        """Say the gains."""
        lines = []
        for name, gains in self.gains.items():
            if not gains:
                lines.append(f"{name}: no gain, the motion loop alone")
                continue
            units = self.units[name]
            gain_texts = (f"{gain} = {value:.6g} {units[gain]}" for gain, value in gains.items())
            lines.append(f"{name}: {', '.join(text.rstrip() for text in gain_texts)}")
        return "\n".join(lines)


def motion_summary(analysis: DesignAnalysis) -> dict[str, Any]:
    """Describe which motion loop G is in use."""
    return {
        "source": analysis.motion_source,
        "numerator": list(analysis.motion.numerator),
        "denominator": list(analysis.motion.denominator),
    }


def meanings(items: Sequence[ImpedanceAnalysis]) -> Iterator[str]:
    """Yield what the values of the table are about."""
    from nrs_design.design.measures import COST_MEANING, LIMIT_MEANING, MEANING, computed

    yield MEANING[0]
    yield LIMIT_MEANING
    yield from computed({item.name: item.proved_titles for item in items})
    yield COST_MEANING


def _summary(item: ImpedanceAnalysis) -> dict[str, Any]:
    from nrs_design.design import measures

    def worst(measure: Measure) -> float | None:
        return finite(item.worst(measure).value)

    band = item.band
    passive, broken = (None, None) if band is None else (band.passive, band.broken)
    return {
        "name": item.name,
        "desired_impedance": item.problem.desired,
        "environment": item.problem.loop.contact.spec_fields(),
        "stiffness": item.problem.loop.contact.stiffness,
        "Mt": item.Mt,
        "Bt": item.Bt,
        "Kt": item.problem.loop.Kt,
        "cost": item.cost,
        "given": [gain for gain in ("Mt", "Bt") if getattr(item.given, gain).fixed],
        "optimum": {"Mt": item.optimum.Mt, "Bt": item.optimum.Bt, "cost": item.optimum.cost},
        "sensitivity_peak": worst(measures.SENSITIVITY_PEAK),
        "gain_margin": worst(measures.GAIN_MARGIN),
        "phase_margin_rad": worst(measures.PHASE_MARGIN),
        "delay_margin_s": worst(measures.DELAY_MARGIN),
        "disk_margin": worst(measures.DISK_MARGIN),
        "stiffness_limit": finite(item.lowest_limit),
        "stiffness_limit_at": item.limit_at,
        "over": [*meanings([item])],
        "lever_arm_m": item.lever_arm,
        "stiffness_limit_at_arm_N_m": item.limit_at_arm and finite(item.limit_at_arm),
        "passive_up_to_rad_s": passive and lower_float(passive),
        "not_passive_at_rad_s": broken and upper_float(broken),
        "goals": goals_summary(item),
        "units": {
            "Mt": unit("kg*m^2"),
            "Bt": unit("N*m*s/rad"),
            "Kt": unit("N*m/rad"),
            "impedance": unit("N*m*s/rad"),
            "stiffness": unit("N*m/rad"),
        },
    }


def _sensor(designed: Designed) -> dict[str, Any]:
    """Return the lasting error of the force signal, in N m, rounded up."""
    sensor = designed.design.sensor
    return {
        "lasting_error": upper_float(sensor.lasting),
        "parts": {name: upper_float(error) for name, error in sensor.errors.items()},
        "unit": unit("N*m"),
    }


def goals_summary(item: AbstractControllerAnalysis) -> list[dict[str, Any]]:
    """Return all measures with their goals, in SI units."""
    return [_goal(found) for found in item.judged]


def _goal(achievement: Achieved) -> dict[str, Any]:
    measure = achievement.measure
    unfavorable = upper_float if measure.upper else lower_float
    return {
        "goal": measure.goal,
        "wanted": achievement.goal,
        # JSON has no infinity: null is an unlimited margin, an unbounded error, or a value that is
        # not computed (`at` distinguishes the last case).
        "worst": finite(achievement.value),
        # Proved bound for all constant values in the ranges; null without a proof.
        "proved": None if achievement.proved is None else unfavorable(achievement.proved),
        "unit": measure.si_unit,
        "at": achievement.where,
        "status": None if achievement.goal is None else str(achievement.standing),
    }


def finite(value: float) -> float | None:
    """Return a number for JSON, which has no infinity; None says unbounded."""
    return value if math.isfinite(value) else None
