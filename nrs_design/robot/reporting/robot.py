"""The page of a robot: workspace, dynamics, correction of the simplified torque, balance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nrs_design import __version__
from nrs_design.errors import NrsDesignError
from nrs_design.reporting.document import (
    Block,
    Bullets,
    Illustration,
    Light,
    Linked,
    Paragraph,
    Report,
    Section,
    State,
    Table,
)
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.sections.tail import spec_section
from nrs_design.reporting.sections.titles import SPEC
from nrs_design.robot.models.balance import design_balance, examine_balance
from nrs_design.robot.models.correction import (
    DEPTH_SINES,
    TABLE_3_5,
    correction_coefficients,
    thesis_tilts,
    tilt_table,
)
from nrs_design.robot.models.robot import LEGS
from nrs_design.robot.models.workspace import examine_inertia, survey_workspace
from nrs_design.robot.reporting.figures import (
    JOINTS,
    draw_balance,
    draw_correction,
    draw_torque_shares,
    draw_workspace,
)

if TYPE_CHECKING:
    import datetime

    from nrs_design.robot.models.balance import Balance
    from nrs_design.robot.models.robot import Robot
    from nrs_design.robot.models.workspace import WorkspaceSurvey
    from nrs_design.spec import LoadedSpec, RobotSpec

FOOTER = "Page of nrs-design. A model of rigid links in floating point, not a proof."
# Depths of the figures, as shares of the workspace.
_SHARES = (0.0, 0.5, 0.9)
# Least |cosine| between coupler and endoscope that is far from a singular pose.
_NEAR_SINGULAR = 0.1
_WORKSPACE, _BALANCE = "Workspace", "Passive balance"
_LIMITS = (
    "Joints without play, links that do not bend, no friction: what the spec does not say.",
    "Reach is looked at on a grid over the declared workspace, not between its points.",
    "Controllers and stability: those are for a spec of kind interaction-design.",
)


def robot_report(
    loaded: LoadedSpec, spec: RobotSpec, robot: Robot, date: datetime.date | None = None
) -> Report:
    """Return the page about a robot, with tables and figures."""
    survey, inertia = survey_workspace(robot), examine_inertia(robot)
    obstacle, link = survey.obstacle, partial(linked, loaded)
    eigenvalues = ", ".join(map(number, inertia))
    balance = _or_why(lambda: _balance(loaded, spec, robot)) if spec.balance else ()
    balanced = [Section(_BALANCE, balance)] if balance else []
    claim = "Every pose of a grid over the declared workspace is within reach of all legs."
    if obstacle is not None:
        claim = (
            f"{unreachable_share(survey)} of a grid over the declared workspace cannot be reached: "
            f"{obstacle.message}."
        )
    return Report(
        name=spec.name,
        title=spec.title,
        verdict="unreachable" if obstacle else "reachable",
        claim=claim,
        remarks=(),
        facts=(
            ("Moving mass", link(f"{number(robot.moving_mass)} kg", "platform")),
            ("Eigenvalues of M at home", link(f"{eigenvalues} kg·m²", "legs")),
            ("Tilt of the base", link(f"{number(math.degrees(robot.base_tilt))} deg", "base_tilt")),
            ("Package", f"nrs-design {__version__}"),
            ("SHA-256 of the spec", Linked(loaded.sha256, section=SPEC)),
        ),
        sections=(
            _workspace(loaded, robot, survey),
            Section("Dynamics", _or_why(lambda: _dynamics(robot))),
            Section("Correction of the simplified torque", _or_why(lambda: _correction(robot))),
            *balanced,
            Section("What is not said", (Bullets("", _LIMITS),), boxed=True),
            spec_section(loaded),
        ),
        footer=FOOTER,
        lights=tuple(_lights(spec, survey)),
        date=date,
    )


def unreachable_share(survey: WorkspaceSurvey) -> str:
    """Write the share of unreachable poses in percent, rounded up."""
    return f"{math.ceil(1e4 * (1 - survey.reachable)) / 100:g} %"


def _lights(spec: RobotSpec, survey: WorkspaceSurvey) -> Iterator[Light]:
    is_reached, text = survey.obstacle is None, "the whole declared workspace"
    state = State.GOOD if is_reached else State.BAD
    yield Light("Reach", state, text if is_reached else f"not {text}", _WORKSPACE)
    nearest = float(np.min(survey.coupler_margin))
    state = State.GOOD if nearest > _NEAR_SINGULAR else State.DOUBTFUL
    text = f"couplers stay {number(nearest, 3)} from singular (|cosine|)"
    yield Light("Singular poses", state, text, _WORKSPACE)
    if spec.balance is None:
        yield Light("Balance", State.UNKNOWN, "the spec declares none")
    else:
        yield Light("Balance", State.GOOD, "counter-masses and springs are designed", _BALANCE)


def workspace_tables(loaded: LoadedSpec, survey: WorkspaceSurvey) -> tuple[Table, Table]:
    """Return the ranges of the joints, and how deep the robot reaches at the corners."""
    turn, link = np.degrees, partial(linked, loaded)
    ranges = zip(survey.joint_low, survey.joint_high, strict=True)
    margins = zip(survey.reach_margin, survey.coupler_margin, strict=True)
    joints = tuple(
        (
            name,
            link(f"{number(turn(low))} to {number(turn(high))}", "legs", leg),
            link(number(1e3 * margin), "legs", leg),
            link(number(coupler, 3), "legs", leg),
        )
        for leg, name, (low, high), (margin, coupler) in zip(
            LEGS, JOINTS, ranges, margins, strict=True
        )
    )
    corners = tuple(
        (
            link(number(turn(phi)), "workspace", "phi"),
            link(number(turn(psi)), "workspace", "psi"),
            link("no depth" if d is None else number(1e3 * d), "workspace", "d"),
        )
        for phi, psi, d in survey.deepest
    )
    columns = ("Joint", "Angle [deg]", "Least reach margin [mm]", "Least coupler margin [1]")
    depths = ("φ [deg]", "ψ [deg]", "Deepest [mm]")
    return (
        Table("Joints over the reachable workspace", columns, joints),
        Table("Deepest reachable pose at the corners", depths, corners),
    )


def _workspace(loaded: LoadedSpec, robot: Robot, survey: WorkspaceSurvey) -> Section:
    figure = Illustration(
        "workspace",
        "Reach over the workspace",
        "Distance of the critical leg from its limit, at three depths. White: some leg cannot "
        "reach.",
        draw_workspace(robot),
    )
    return Section(_WORKSPACE, (*workspace_tables(loaded, survey), figure))


def _dynamics(robot: Robot) -> Iterator[Block]:
    low, high = robot.workspace.d
    depths = [low + share * (high - low) for share in _SHARES]
    yield Illustration(
        "torque-shares",
        "Composition of the torques",
        "Mean shares of gravity, velocities and accelerations over poses at three depths, at the "
        "joint speeds and accelerations of thesis 3.3.",
        draw_torque_shares(robot, depths),
    )


def _correction(robot: Robot) -> Iterator[Block]:
    tables = (tilt_table(robot, thesis_tilts(), sines) for sines in (DEPTH_SINES, TABLE_3_5))
    found = correction_coefficients(robot, TABLE_3_5)
    quantities = found.mean_ratio, found.least_squares, found.least_squares_error
    rows = tuple((name, *map(number, row)) for name, *row in zip(JOINTS, *quantities, strict=True))
    yield Paragraph(
        "Ratio of the torques of the full and the simplified model. A controller can evaluate the "
        "simplified model at every tick."
    )
    columns = ("Joint", "Mean ratio [1]", "Least squares [1]", "Error left [N·m]")
    yield Table("Coefficients over all motions of thesis table 3.5", columns, rows)
    yield Illustration(
        "correction",
        "Correction over the tilt of the base",
        "For motions of the depth alone, and with the angles.",
        draw_correction(*tables),
    )


def balance_table(loaded: LoadedSpec, design: Balance) -> Table:
    """Return the counter-masses and springs of both side legs."""
    rows = []
    for leg, found in (("left", design.left_leg), ("right", design.right_leg)):
        masses = (found.arm_mass, found.coupler_mass, found.total_mass)
        values = *(1e3 * mass for mass in masses), 1e3 * found.total_distance
        numbers = (*values, 1e-3 * found.stiffness)
        rows.append((leg, *(linked(loaded, number(value), "balance") for value in numbers)))
    columns = ("Leg", "M_c [g]", "M_b [g]", "M_a [g]", "B_a [mm]", "Spring k [N/mm]")
    return Table("Counter-masses and springs", columns, tuple(rows))


def _balance(loaded: LoadedSpec, spec: RobotSpec, robot: Robot) -> Iterator[Block]:
    design = design_balance(spec, robot)
    yield balance_table(loaded, design)
    yield Illustration(
        "balance",
        "Static torque without and with balance",
        "Over the reachable workspace, on a base tilted by "
        f"{number(math.degrees(design.tilt))} deg.",
        draw_balance(*examine_balance(robot, design)),
    )


def _or_why(make: Callable[[], Iterable[Block]]) -> tuple[Block, ...]:
    """Return what a section shows, or why there is nothing to show for this robot."""
    try:
        return tuple(make())
    except NrsDesignError as error:
        return (Paragraph(f"Not computed: {error.message}."),)
