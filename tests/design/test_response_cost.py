"""Transparency and accuracy in the cost: by hand, against python-control, and what they choose."""

import re

import control
import numpy as np
import pytest

from nrs_design.design.impedance import ImpedanceLoop
from nrs_design.design.response_cost import response_cost
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import KelvinVoigt
from tests.design.motion_loops import EXACT
from tests.support import ROOT, document_of, run

LAG = TransferFunction((1.0,), (1.0, 1.0))
TISSUE = KelvinVoigt(3, 0.5)
EXAMPLE = ROOT / "docs/examples/transparency.nrs.yaml"


def test_by_hand():
    """At 1 rad/s, |2 s + 8| |s + 1| = sqrt(68 2), over a limit of 2 and with a weight of 3."""
    loop = ImpedanceLoop(LAG, TISSUE)
    part = response_cost(loop, 3.0, 2.0, (0.0, 1.0), touches=False)
    assert part.of(np.array([[2.0]]), np.array([[8.0]])) == pytest.approx(3 / 2 * np.sqrt(136))


def test_the_tracking_error_against_python_control():
    loop = ImpedanceLoop(EXACT, TISSUE)
    part = response_cost(loop, 1.0, 1.0, (1.0, 12.0), touches=True)
    G = control.tf([*EXACT.numerator], [*EXACT.denominator])
    L = G * control.tf([0.5, 3], [1, 0]) * control.tf([1], [0.1, 2])
    grid = np.abs(1 - (G / (1 + L))(1j * np.linspace(1, 12, 2000))).max()
    found = part.of(np.array([[0.1]]), np.array([[2.0]]))
    assert found == pytest.approx(grid, rel=2e-2)
    assert found <= grid * (1 + 1e-6)


def chosen(tmp_path, weights):
    """Return the damping that is chosen between 0.5 and 20 N m s/rad."""
    text = EXAMPLE.read_text("utf-8")
    fixed = "Bt: 2 N*m*s/rad"
    free = f"Bt: {{min: 0.5 N*m*s/rad, max: 20 N*m*s/rad}}\n    weights: {weights}"
    assert fixed in text
    path = tmp_path / "weighed.nrs.yaml"
    path.write_text(text.replace(fixed, free), encoding="utf-8")
    (item,) = document_of("optimize", path, cwd=tmp_path)["controllers"]
    assert any("add the largest response" in said for said in item["over"]) == (
        "transparency" in weights or "accuracy" in weights
    )
    return item["Bt"]


def test_weights_move_the_gains(tmp_path):
    """Transparency asks for little damping, accuracy against tissue for much."""
    plain = chosen(tmp_path, "{displayed: 1}")
    light = chosen(tmp_path, "{displayed: 1, transparency: 5}")
    stiff = chosen(tmp_path, "{displayed: 1, accuracy: 5}")
    assert light < plain < stiff


@pytest.mark.parametrize(
    ("weights", "goal", "said"),
    [
        ("{transparency: 1}", "  transparency:", "no goal says in which band"),
        ("{accuracy: 1}", ", environment: tissue", "gains have no part in it"),
        ("{transparency: -1}", "#", "zero or positive"),
    ],
)
def test_a_weight_without_its_goal_is_refused(tmp_path, weights, goal, said):
    text = EXAMPLE.read_text("utf-8").replace(
        "    Mt: 0.01", f"    weights: {weights}\n    Mt: 0.01"
    )
    if goal == "  transparency:":
        text = "".join(f"{line}\n" for line in text.splitlines() if goal not in line)
    else:
        text = text.replace(goal, "" if goal != "#" else goal)
    path = tmp_path / "refused.nrs.yaml"
    path.write_text(text, encoding="utf-8")
    result = run("check", path, cwd=tmp_path, code=2)
    assert said in result.stderr
    line = int(re.search(r"\.yaml:(\d+):", result.stderr)[1])
    assert "weights" in text.splitlines()[line - 1]
