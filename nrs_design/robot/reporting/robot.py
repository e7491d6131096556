"""The page of a robot: workspace, dynamics, correction of the simplified torque, balance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
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
    tilt_tables,
)
from nrs_design.robot.models.robot import LEGS
from nrs_design.robot.models.workspace import (
    examine_inertia,
    survey_workspace,
)
from nrs_design.robot.reporting.figures import (
    JOINTS,
    draw_balance,
    draw_correction,
    draw_torque_shares,
    draw_workspace,
)

if TYPE_CHECKING:
    import datetime

    from nrs_design.robot.models.robot import Robot
    from nrs_design.robot.models.workspace import WorkspaceSurvey
    from nrs_design.spec import LoadedSpec, RobotSpec

FOOTER = "Page of nrs-design. A model of rigid links in floating point, not a proof."
# Where the depths of the workspace are looked at.
_SHARES = (0.0, 0.5, 0.9)
# Least |cosine| between coupler and endoscope that is far from a singular pose.
_NEAR_SINGULAR = 0.1
_LIMITS = (
    "Joints without play, links that do not bend, no friction: what the spec does not say.",
    "Reach is looked at on a grid over the declared workspace, not between its points.",
    "Controllers and stability: those are for a spec of kind interaction-design.",
)


def robot_report(
    loaded: LoadedSpec, spec: RobotSpec, robot: Robot, date: datetime.date | None = None
) -> Report:
    """Say and draw everything about a robot."""
    survey, inertia = survey_workspace(robot), examine_inertia(robot)
    reached, at = survey.obstacle is None, partial(linked, loaded)
    return Report(
        name=spec.name,
        title=spec.title,
        verdict="reachable" if reached else "unreachable",
        claim=_claim(survey),
        remarks=(),
        facts=(
            ("Moving mass", at(f"{number(robot.moving_mass)} kg", "platform")),
            (
                "Eigenvalues of M at home",
                at(f"{', '.join(number(v) for v in inertia)} kg·m²", "legs"),
            ),
            ("Tilt of the base", at(f"{number(math.degrees(robot.base_tilt))} deg", "base_tilt")),
            ("Package", f"nrs-design {__version__}"),
            ("SHA-256 of the spec", Linked(loaded.sha256, section=SPEC)),
        ),
        sections=(
            _workspace(loaded, robot, survey),
            _dynamics(robot),
            _correction(robot),
            *_balance(loaded, spec, robot),
            Section("What is not said", (Bullets("", _LIMITS),), boxed=True),
            spec_section(loaded),
        ),
        footer=FOOTER,
        lights=tuple(_lights(spec, survey)),
        date=date,
    )


def _claim(survey: WorkspaceSurvey) -> str:
    if survey.obstacle is None:
        return "Every pose of a grid over the declared workspace is within reach of all legs."
    share = math.ceil(1e4 * (1 - survey.reachable)) / 100
    return (
        f"{share:g} % of a grid over the declared workspace cannot be reached: "
        f"{survey.obstacle.message}."
    )


def _lights(spec: RobotSpec, survey: WorkspaceSurvey) -> Iterator[Light]:
    if survey.obstacle is None:
        yield Light("Reach", State.GOOD, "the whole declared workspace", _WORKSPACE)
    else:
        yield Light("Reach", State.BAD, "not the whole declared workspace", _WORKSPACE)
    nearest = float(np.min(survey.coupler_margin))
    state = State.GOOD if nearest > _NEAR_SINGULAR else State.DOUBTFUL
    text = f"couplers stay {number(nearest, 3)} from singular (|cosine|)"
    yield Light("Singular poses", state, text, _WORKSPACE)
    if spec.balance is None:
        yield Light("Balance", State.UNKNOWN, "the spec declares none")
    else:
        yield Light("Balance", State.GOOD, "counter-masses and springs are designed", _BALANCE)


_WORKSPACE, _BALANCE = "Workspace", "Passive balance"


def _workspace(loaded: LoadedSpec, robot: Robot, survey: WorkspaceSurvey) -> Section:
    turn, at = np.degrees, partial(linked, loaded)
    rows = tuple(
        (
            name,
            at(f"{number(turn(low))} to {number(turn(high))}", "legs", leg),
            at(number(1e3 * reach), "legs", leg),
            at(number(coupler, 3), "legs", leg),
        )
        for leg, name, low, high, reach, coupler in zip(
            LEGS,
            JOINTS,
            survey.joint_low,
            survey.joint_high,
            survey.reach_margin,
            survey.coupler_margin,
            strict=True,
        )
    )
    columns = ("Joint", "Angle [deg]", "Least reach margin [mm]", "Least coupler margin [1]")
    corners = tuple(
        (
            at(number(turn(phi)), "workspace", "phi"),
            at(number(turn(psi)), "workspace", "psi"),
            at("no depth" if d is None else number(1e3 * d), "workspace", "d"),
        )
        for phi, psi, d in survey.deepest
    )
    depths = ("φ [deg]", "ψ [deg]", "Deepest [mm]")
    return Section(
        _WORKSPACE,
        (
            Table("Joints over the reachable workspace", columns, rows),
            Table("Deepest reachable pose at the corners", depths, corners),
            Illustration(
                "workspace",
                "Reach over the workspace",
                "How far the leg that is nearest to its limit is from it, at three depths. White: "
                "some leg cannot reach.",
                draw_workspace(robot),
            ),
        ),
    )


def _dynamics(robot: Robot) -> Section:
    low, high = robot.workspace.d
    depths = [low + share * (high - low) for share in _SHARES]

    def drawn() -> tuple[Block, ...]:
        return (
            Illustration(
                "torque-shares",
                "What the torques are made of",
                "Mean shares of gravity, velocities and accelerations over poses at three depths, "
                "at the joint speeds and accelerations of thesis 3.3.",
                draw_torque_shares(robot, depths),
            ),
        )

    return Section("Dynamics", _or_why(drawn))


def _correction(robot: Robot) -> Section:
    def drawn() -> tuple[Block, ...]:
        depth, every = tilt_tables(robot, thesis_tilts(), DEPTH_SINES, TABLE_3_5)
        found = correction_coefficients(robot, TABLE_3_5)
        shown = found.mean_ratio, found.least_squares, found.least_squares_error
        rows = tuple((name, *map(number, row)) for name, *row in zip(JOINTS, *shown, strict=True))
        columns = ("Joint", "Mean ratio [1]", "Least squares [1]", "Error left [N·m]")
        return (
            Paragraph(
                "Torque of the full model over that of the simplified one, which a controller can "
                "evaluate at every tick."
            ),
            Table("Coefficients over all motions of thesis table 3.5", columns, rows),
            Illustration(
                "correction",
                "Correction over the tilt of the base",
                "For motions of the depth alone, and with the angles.",
                draw_correction(depth, every),
            ),
        )

    return Section("Correction of the simplified torque", _or_why(drawn))


def _balance(loaded: LoadedSpec, spec: RobotSpec, robot: Robot) -> tuple[Section, ...]:
    if spec.balance is None:
        return ()

    def drawn() -> tuple[Block, ...]:
        wanted = design_balance(spec, robot)
        torques = examine_balance(robot, wanted)
        rows = tuple(
            (
                leg,
                *(
                    linked(loaded, number(value), "balance")
                    for value in (
                        1e3 * found.arm_mass,
                        1e3 * found.coupler_mass,
                        1e3 * found.total_mass,
                        1e3 * found.total_distance,
                        1e-3 * found.stiffness,
                    )
                ),
            )
            for leg, found in (("left", wanted.left), ("right", wanted.right))
        )
        columns = ("Leg", "M_c [g]", "M_b [g]", "M_a [g]", "B_a [mm]", "Spring k [N/mm]")
        return (
            Table("Counter-masses and springs", columns, rows),
            Illustration(
                "balance",
                "Static torque without and with balance",
                f"Over the reachable workspace, on a base tilted by "
                f"{number(math.degrees(wanted.tilt))} deg.",
                draw_balance(torques.gravity, torques.residual),
            ),
        )

    return (Section(_BALANCE, _or_why(drawn)),)


def _or_why(make: Callable[[], tuple[Block, ...]]) -> tuple[Block, ...]:
    """Return what a section shows, or why there is nothing to show for this robot."""
    try:
        return make()
    except NrsDesignError as error:
        return (Paragraph(f"Not computed: {error.message}."),)
