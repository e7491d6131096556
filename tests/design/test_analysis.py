"""What a design achieves, as people see it."""

import pytest

from nrs_design.pipeline import run_analysis, run_design
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE

# Thesis 6.1 as printed.
GIVEN = """motion_loop:
  transfer_function: {numerator: [0.99, 56.82], denominator: [0.0351, 1.99, 56.82]}
"""


def analysis(path):
    loaded = read_spec(path)
    return run_analysis(run_design(loaded))


def test_motion_loop_of_the_thesis():
    found = analysis(SOFT_TISSUE)
    assert found.motion_source == "designed"
    assert found.wanted.zero == pytest.approx(56.9706, rel=5e-4)
    assert max(pole.imag for pole in found.reached.poles) == pytest.approx(28.448, rel=1e-3)
    assert found.reached.overshoot == pytest.approx(0.068, abs=2e-3)
    assert [item.name for item in found.impedance] == ["insertion", "withdrawal"]
    assert found.force == ()


def test_shipped_gains_are_nearly_optimal():
    for item in analysis(SOFT_TISSUE).impedance:
        assert item.optimum.cost <= item.cost < item.optimum.cost * 1.01
        assert item.Bt == pytest.approx(item.optimum.Bt, rel=5e-3)
        assert item.lowest_limit > item.problem.loop.contact.stiffness


def test_given_motion_loop(tmp_path):
    text = SOFT_TISSUE.read_text().replace("motion_loop:\n", GIVEN)
    path = tmp_path / "given.nrs.yaml"
    path.write_text(text)
    found = analysis(path)
    assert found.motion_source == "given"
    assert found.motion.numerator == (0.99, 56.82)
