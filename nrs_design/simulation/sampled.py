"""The sampled engine: what a spec says, as a processor runs it; see `sampled_axis`."""

from __future__ import annotations

import math

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.replica import StepProgram
from nrs_design.controllers.shipped import shipped_law
from nrs_design.errors import DesignError
from nrs_design.models.plant import Plant
from nrs_design.progress import Progress, silent
from nrs_design.simulation.run import MAX_STEPS, Run
from nrs_design.simulation.sampled_axis import SampledAxis, draw_samples
from nrs_design.simulation.scenario import Scenario
from nrs_design.spec import InteractionDesignSpec


def simulate_sampled(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenario: Scenario,
    *,
    max_steps: int = MAX_STEPS,
    tell: Progress = silent,
) -> Run:
    """Simulate a scenario with the exported law, for at most `max_steps` samples."""
    axis = _axis(spec, plant, design, scenario)
    wanted = math.floor(scenario.duration / axis.T + 1e-9) + 1
    count = min(wanted, max_steps)
    samples = draw_samples(scenario, axis.sampling, axis.late, count)
    stopped = None
    if count < wanted:
        stopped = f"{max_steps} samples by {samples[-1].time:.6g} s: the budget is used up"
    return axis.run(samples, stopped, tell)


def _axis(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign, scenario: Scenario
) -> SampledAxis:
    """Return an axis with its law, at rest at the start of a scenario, its motor the nominal one.

    Noise, jitter and delay come from the seed of the scenario. A `DesignError` if the spec has no
    sampling or periods that never meet, states the motion loop itself, if the command swings faster
    than samples can show, or there is no program of a controller.
    """
    if spec.sampling is None:
        raise DesignError(
            "the spec does not say how often the law runs",
            remedy="add `sampling: {period: 2 ms, delay: 0}`",
        )
    if plant.given_loop is not None and not design.takes:
        raise DesignError(
            "the spec states the motion loop itself, so there is no motor to simulate",
            remedy="leave transfer_function out, or use --engine exact",
            at=("motion_loop", "transfer_function"),
        )
    sampling = spec.sampling
    odd = sampling.find_odd_periods()
    if odd is not None:
        raise DesignError(
            f"the two loops do not meet at common samples: {odd}",
            remedy="let the longer period be a whole number of the shorter one",
            at=("sampling",),
        )
    if scenario.profile.omega * float(sampling.step) >= math.pi:
        raise DesignError(
            f"a command of {scenario.profile.omega / math.tau:.6g} Hz swings faster than samples "
            f"of {float(sampling.step):.6g} s can show: the law would see a slower one",
            remedy="command less than half a swing a sample, or use --engine exact",
            at=("scenarios", scenario.name, "command", "sinusoid", "frequency"),
        )
    period, outer = sampling.period.exact, sampling.outer
    others = [c.name for c in design.controllers if c.law.commands != "velocity"]
    if outer != period and (others or spec.mode_logic is not None):
        raise DesignError(
            f"two periods are simulated for impedance controllers alone, without mode_logic"
            f"{f', and {others[0]} is another' if others else ''}",
            remedy="let both loops have one period",
            at=("controllers", others[0]) if others else ("mode_logic",),
        )
    try:
        program = StepProgram(shipped_law(spec, design, period, outer))
    except DesignError as error:
        raise DesignError(error.message, remedy="use --engine exact", at=error.at) from None
    if sampling.misses is not None and outer != period:
        raise DesignError(
            "missed deadlines are simulated for one period of all loops",
            remedy="leave outer_period out",
            at=("sampling", "misses"),
        )
    shortest, longest = spec.late
    late = float(shortest), float(longest)
    return SampledAxis(plant, design, scenario, program, sampling, late)
