"""The law that ships on a body of choice: a motor, a robot, or either of them in MuJoCo."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.models.plant import Plant
from nrs_design.progress import Progress, silent
from nrs_design.simulation.processor import AbstractBody, Motors, run_axes
from nrs_design.simulation.run import LEFT_OUT_ON_LINKS, MAX_STEPS, Deviation, Run
from nrs_design.simulation.sampled import sampled_axis
from nrs_design.simulation.sampled_axis import SampledAxis
from nrs_design.simulation.scenario import Scenario
from nrs_design.spec import InteractionDesignSpec
from nrs_design.wings import load_wing

SAMPLED, MUJOCO = "sampled", "mujoco"


def simulate_on_body(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenarios: Sequence[Scenario],
    engine: str,
    arm: object | None = None,
    *,
    max_steps: int = MAX_STEPS,
    tell: Progress = silent,
) -> tuple[Run, ...]:
    """Simulate one axis, or three axes of a robot, with the law that ships.

    Parameters
    ----------
    spec, plant, design
        As `nrs_design.simulation.sampled.sampled_axis` takes them.
    scenarios : sequence of Scenario
        One, or those of theta1 to theta3.
    engine : {"sampled", "mujoco"}
        What moves. With MuJoCo the sampled engine runs as well, and the runs say how far they are
        from it.
    arm : Arm, optional
        The robot of three axes, as the wing of robots builds it.
    max_steps : int
        A run that takes more samples ends there.
    tell : callable
        Told how far the run is.

    Returns
    -------
    tuple of Run
        One for each axis.

    Raises
    ------
    DesignError
        If there is no law, MuJoCo is not installed, or the simulation runs away.
    PoseError
        If the robot cannot reach its pose of rest.
    """

    def run(name: str) -> tuple[Run, ...]:
        axes = tuple(sampled_axis(spec, plant, design, one) for one in scenarios)
        runs = run_axes(axes, _body(name, axes, plant, arm), name, max_steps, tell)
        if arm is None:
            return runs
        return tuple(replace(one, left_out=LEFT_OUT_ON_LINKS) for one in runs)

    runs = run(engine)
    if engine == SAMPLED:
        return runs
    others = run(SAMPLED)
    return tuple(
        replace(one, deviation=deviation(one, other))
        for one, other in zip(runs, others, strict=True)
    )


def deviation(run: Run, other: Run) -> Deviation:
    """Return how far two runs with the same samples are apart, as far as both have come.

    Parameters
    ----------
    run, other : Run
        Of the same scenario.
    """
    count = min(len(run.response), len(other.response))
    return Deviation(
        *(
            float(abs(run.response[name][:count] - other.response[name][:count]).max())
            for name in ("angle", "velocity", "torque")
        )
    )


def _body(name: str, axes: Sequence[SampledAxis], plant: Plant, arm: object | None) -> AbstractBody:
    if name == SAMPLED and arm is None:
        return Motors()
    body: AbstractBody = load_wing("robot", "simulation.bodies").body_of(axes, plant, arm, name)
    return body
