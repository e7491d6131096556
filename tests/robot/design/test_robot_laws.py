"""The laws of a robot that ship: with the gains of the simulated ones, and its limits."""

from dataclasses import replace

import pytest

from nrs_design.controllers.float32 import is_float32
from nrs_design.errors import DesignError
from nrs_design.robot.design.robot_laws import design_robot_laws
from nrs_design.robot.models import Workspace, build_robot, thesis_tilts, tilt_table, to_csv
from nrs_design.spec import parse_spec
from tests.support import ROOT

TEXT = (ROOT / "specs/robots/neuroboscope.nrs.yaml").read_text()


@pytest.mark.slow
def test_numbers_are_those_of_the_spec_and_of_the_table():
    old = "encoder_counts: 8192"
    assert old in TEXT
    spec = parse_spec(TEXT.replace(old, f"{old}\n  largest_command: 3333.3 rpm"))
    robot = build_robot(spec)
    laws = design_robot_laws(spec, robot)
    assert list(laws) == ["base", "pd", "pd_gravity", "computed_torque", "inverse_dynamics"]
    for name in ("pd", "pd_gravity", "computed_torque"):
        (limit,) = laws[name].coefficient["command_limit"].values
        assert is_float32(limit)
        assert 3333.2 < limit <= 3333.3
    for name in ("pd", "pd_gravity"):
        # Thesis 4.30: 2060 (s + 56.9706).
        assert float(laws[name].coefficient["Kp"].values[0]) == pytest.approx(117359.436, rel=1e-7)
        assert laws[name].coefficient["Kd_over_T"].values == (1_030_000,)
    rows = [line.split(",") for line in to_csv(tilt_table(robot, thesis_tilts())).splitlines()[1:]]
    for joint in (1, 2, 3):
        held = laws["base"].coefficient[f"correction_table_{joint}"].values
        assert [f"{float(value):.6f}" for value in held] == [row[joint] for row in rows]


def test_a_workspace_that_the_program_does_not_take_is_refused():
    """The crank of the middle leg turns further, the nearer the endoscope is to the pivot."""
    spec = parse_spec(TEXT)
    robot = build_robot(spec)
    wide = replace(robot, workspace=Workspace(0.1, 0.8, (0.05, 0.2)))
    with pytest.raises(
        DesignError, match=r"theta3 turns to \S+ rad within the workspace"
    ) as caught:
        design_robot_laws(spec, wide)
    assert caught.value.at == ("workspace",)


@pytest.mark.slow
def test_a_robot_without_control_has_none():
    spec = parse_spec(TEXT).model_copy(update={"control": None})
    with pytest.raises(DesignError, match="no `control`"):
        design_robot_laws(spec, build_robot(spec))
