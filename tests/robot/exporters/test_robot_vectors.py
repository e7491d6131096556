"""Vectors of a robot's laws: cases of the replica, with the spec that they belong to."""

import json

import numpy as np

from nrs_design.controllers.replica import step
from nrs_design.robot.exporters.robot_tree import RobotExport
from nrs_design.robot.exporters.vectors import text
from nrs_design.robot.models import build_robot


def test_cases_are_those_of_the_replica(loaded, control_laws):
    """Most of them valid, all bits as they are."""
    exported = RobotExport(loaded, build_robot(loaded.spec), "robot.nrs.yaml")
    written = text(exported, control_laws, 60)
    document = json.loads(written)
    assert document["schema"] == "nrs-design/robot-vectors/1"
    assert '"origin": "spec file: robot.nrs.yaml"' in written
    assert any(line.startswith("verdict: UNPROVED") for line in document["about"])
    for name, law in control_laws.items():
        part = document["laws"][name]
        rows = [case.split() for case in part["cases"]]
        assert len(rows) == 60
        columns = dict(zip(part["columns"], zip(*rows, strict=True), strict=True))
        read = {key: bits_of(values) for key, values in columns.items() if key != "valid"}
        given = {key: read[key] for key in part["inputs"]}
        given |= {key: read[f"before.{key}"] for key in part["states"]}
        result = step(law, np.zeros(60, np.uint32), given)
        assert list(map(str, result.valid.astype(int))) == list(columns["valid"])
        assert result.valid.mean() > 0.4
        for key, values in result.outputs.items():
            assert (values.view(np.uint32) == read[key].view(np.uint32)).all()
        for key, values in result.states.items():
            assert (values.view(np.uint32) == read[f"after.{key}"].view(np.uint32)).all()


def bits_of(texts):
    return np.array([int(text, 16) for text in texts], np.uint32).view(np.float32)
