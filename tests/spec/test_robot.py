"""Robot specs: what they hold, and what is refused."""

import pytest

from nrs_design.robot.models.robot import build_robot
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import TEMPLATES

from .samples import spoiled

TEXT = TEMPLATES["robot"]
ROD = "crank: {mass: 73.3 g, center_of_mass: [75.6 mm, 0 mm, 0 mm], inertia: slender-rod}"
TENSOR = (
    "crank: {mass: 73.3 g, center_of_mass: [75.6 mm, 1 mm, -2 mm], inertia: tensor, "
    "tensor: {xx: 10 g*mm^2, yy: 111324.375 g*mm^2, zz: 111324.375 g*mm^2, xy: -3 g*mm^2}}"
)


def test_tensor_instead_of_rod() -> None:
    robot = build_robot(parse_spec(spoiled(TEXT, ROD, TENSOR)))
    crank = robot.legs[0].crank
    assert crank.center_of_mass == pytest.approx([0.0756, 0.001, -0.002])
    assert crank.inertia[1, 1] == pytest.approx(0.0733 * 0.135**2 / 12)
    assert crank.inertia[0, 1] == crank.inertia[1, 0] == pytest.approx(-3e-9)
    assert crank.inertia[0, 2] == pytest.approx(0, abs=1e-18)
