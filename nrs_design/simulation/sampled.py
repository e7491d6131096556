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
from nrs_design.spec.sampling import SamplingSpec


def simulate_sampled(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenario: Scenario,
    *,
    max_steps: int = MAX_STEPS,
    progress: Progress = silent,
) -> Run:
    """Simulate a scenario with the exported law, for at most `max_steps` samples.

    The axis is at rest at first, and its motor the nominal one. Noise, jitter and delay come from
    the seed of the scenario. A `DesignError` if `_sampling` refuses, or a controller has no
    program.
    """
    sampling = _sampling(spec, plant, design, scenario)
    try:
        law = shipped_law(spec, design, sampling.period.exact, sampling.outer)
    except DesignError as error:
        raise DesignError(error.message, remedy="use --engine exact", at=error.at) from None
    axis = SampledAxis(plant, design, scenario, StepProgram(law), sampling)
    complete = math.floor(scenario.duration / axis.T + 1e-9) + 1
    shortest, longest = spec.late
    delays = float(shortest), float(longest)
    samples = draw_samples(scenario, sampling, delays, min(complete, max_steps))
    stopped = None
    if len(samples) < complete:
        stopped = f"{max_steps} samples by {samples[-1].time:.6g} s: the budget is used up"
    return axis.run(samples, stopped, progress)


def _sampling(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign, scenario: Scenario
) -> SamplingSpec:
    """Return the sampling of a spec.

    A `DesignError` if the spec has none or periods that never meet, states the motion loop itself,
    has what is simulated for one period alone, or if the command swings faster than samples show.
    """
    sampling, omega = spec.sampling, scenario.profile.omega
    if sampling is None:
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
    odd = sampling.find_odd_periods()
    if odd is not None:
        raise DesignError(
            f"the two loops do not meet at common samples: {odd}",
            remedy="make the longer period an integer multiple of the shorter period",
            at=("sampling",),
        )
    if omega * float(sampling.step) >= math.pi:
        raise DesignError(
            f"a command of {omega / math.tau:.6g} Hz swings faster than samples "
            f"of {float(sampling.step):.6g} s can show: the law would see a slower one",
            remedy="command less than half a swing a sample, or use --engine exact",
            at=("scenarios", scenario.name, "command", "sinusoid", "frequency"),
        )
    if sampling.outer == sampling.period.exact:
        return sampling
    others = [c.name for c in design.controllers if c.law.commands != "velocity"]
    if others or spec.mode_logic is not None:
        raise DesignError(
            f"two periods are simulated for impedance controllers alone, without mode_logic"
            f"{f', and {others[0]} is another' if others else ''}",
            remedy="let both loops have one period",
            at=("controllers", others[0]) if others else ("mode_logic",),
        )
    if sampling.misses is not None:
        raise DesignError(
            "missed deadlines are simulated for one period of all loops",
            remedy="leave outer_period out",
            at=("sampling", "misses"),
        )
    return sampling
