"""From the spec of a robot to the robot, its motion control, and its rigorous bounds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import placed, wrong_kind
from nrs_design.progress import Progress, silent
from nrs_design.spec import LoadedSpec, read_spec

if TYPE_CHECKING:
    from nrs_design.controllers.operations import StepLaw
    from nrs_design.robot.models import Robot
    from nrs_design.robot.models.arm import ArmMobility
    from nrs_design.robot.simulation.robot_body import Arm
    from nrs_design.spec import RobotSpec


def run_robot(path: Path) -> tuple[LoadedSpec, RobotSpec, Robot]:
    """Read a robot spec and build the robot."""
    from nrs_design.robot.models import build_robot

    loaded = read_spec(path)
    if loaded.spec.kind != "robot":
        raise wrong_kind(
            loaded,
            f"a spec of kind {loaded.spec.kind} describes no robot",
            "name a spec of kind robot; `nrs-design init robot` writes one",
        )
    with placed(loaded):
        return loaded, loaded.spec, build_robot(loaded.spec)


def build_arm(path: Path, rest: tuple[float, float, float] | None, holds: bool) -> Arm:
    """Return a robot that stands in a pose.

    Parameters
    ----------
    path : Path
        The spec of the robot.
    rest : tuple of float or None
        The pose (phi, psi, d) in rad and m; None for its home.
    holds : bool
        Whether gravity is compensated in that pose alone.
    """
    import numpy as np

    from nrs_design.robot.simulation.robot_body import Arm

    _, _, robot = run_robot(path)
    return Arm(robot, robot.home if rest is None else np.array(rest), holds)


def run_robot_laws(spec: RobotSpec, robot: Robot) -> dict[str, StepLaw]:
    """Design the motion control of a robot, and write its laws out as operations.

    Raises
    ------
    DesignError
        If the spec lacks something, or its numbers contradict each other.
    PoseError
        If the robot does not reach the motions that the table of corrections is made for.
    """
    from nrs_design.robot.design.robot_laws import design_robot_laws

    return design_robot_laws(spec, robot)


def check_robot_bounds(
    path: Path, budget: float, progress: Progress = silent
) -> tuple[Path, tuple[str, ...]]:
    """Compute again what the bounds of a robot claim.

    Parameters
    ----------
    path : Path
        The spec of the robot.
    budget : float
        Work for each of the bounds, in units.
    progress : callable
        Told the name of each step.

    Returns
    -------
    Path
        The file of the bounds.
    tuple of str
        What is wrong with them; nothing if they hold.

    Raises
    ------
    SpecError
        If the robot, or the file of its bounds, cannot be read.
    DesignError
        If the work did not suffice to decide something.
    ClockError
        If the clock stopped it.
    """
    from nrs_design.robot.models import confirm_bounds

    return _checked(path, lambda robot, document: confirm_bounds(robot, document, budget, progress))


def contradict_robot_bounds(
    path: Path, progress: Progress = silent
) -> tuple[Path, tuple[str, ...]]:
    """Look for poses that exceed the bounds of a robot, in seconds; none shows nothing.

    Parameters
    ----------
    path : Path
        The spec of the robot.
    progress : callable
        Told the name of each step.

    Returns
    -------
    Path
        The file of the bounds.
    tuple of str
        What is wrong with them; nothing if no pose that was tried exceeds them.

    Raises
    ------
    SpecError
        If the robot, or the file of its bounds, cannot be read.
    """
    from nrs_design.robot.models import contradict_bounds

    return _checked(path, lambda robot, document: contradict_bounds(robot, document, progress))


def run_mobility(path: Path, budget: float, progress: Progress = silent) -> ArmMobility:
    """Judge the mobility of the arm that a file with several axes names.

    Parameters
    ----------
    path : Path
        Of the axes, or one of them.
    budget : float
        Work, in units.
    progress : callable
        Told what is being done.

    Raises
    ------
    SpecError
        If the file or the model is wrong.
    DesignError
        If they do not fit.
    """
    from nrs_design.robot.design.mobility import judge_mobility

    return judge_mobility(path, budget, progress)


def check_mobility(
    path: Path, budget: float, progress: Progress = silent
) -> tuple[Path, tuple[str, ...]]:
    """Compute the mobility that a file declares; as `check_robot_bounds`.

    Parameters
    ----------
    path, budget, progress
        As there.

    Raises
    ------
    SpecError
        If the file or the model is wrong.
    DesignError
        If the work did not suffice to decide.
    """
    found = run_mobility(path, budget, progress)
    if found.verdict == "inconclusive":
        raise DesignError(
            f"the mobility of {found.model.as_posix()} was not shown to stay in the declared range",
            path=path,
            remedy="declare a wider range, use smaller ranges of joints, or give "
            "`nrs-design robot mobility` more --budget",
        )
    return found.model, found.faults


def contradict_mobility(path: Path) -> tuple[Path, tuple[str, ...]]:
    """Look for poses beyond the mobility that a spec declares; as `contradict_robot_bounds`."""
    from nrs_design.robot.design.mobility import judge_mobility

    found = judge_mobility(path, 0.0, poses_only=True)
    return found.model, found.faults


def _checked(
    path: Path, faults: Callable[[Robot, Mapping[str, Any]], Iterator[str]]
) -> tuple[Path, tuple[str, ...]]:
    from nrs_design.spec.robot_bounds import bounds_file, read_bounds

    loaded, _, robot = run_robot(path)
    file = bounds_file(path)
    bounds, document = read_bounds(file)
    if bounds.sha256 != loaded.sha256:
        return file, ("the robot has changed since its bounds were computed",)
    with placed(loaded):
        return file, tuple(faults(robot, document))
