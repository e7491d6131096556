"""Parameters are drawn from their ranges, and what is drawn is what is simulated."""

from pathlib import Path

import numpy as np

from nrs_design.pipeline import run_design
from nrs_design.pipeline.scenarios import Runs, run_scenarios
from nrs_design.spec import parse_spec
from nrs_design.spec.load import LoadedSpec
from tests.simulation.interactions import text_of

WIDE = "{model: elastic, stiffness: {nominal: 40 N*m/rad, range: [20 N*m/rad, 60 N*m/rad]}}"
LAW = "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}"
# Pressed until nothing moves any more: the depth is F/k, with F = Bt v whatever k is (thesis 6.2).
PRESSED = (
    "command: {constant: 8 deg/s}, duration: 0.3 s, surfaces: [{environment: soft, at: 0 deg}]"
)


def drawn(count, tissue=WIDE, law=LAW, motor=None):
    """Runs of a spec, one for each seed."""
    text = text_of({"insertion": law}, {"soft": tissue}, scenario=PRESSED)
    text = text.replace("gain: 4.8417e-4 rad/s/rpm", f"gain: {motor or '4.8417e-4 rad/s/rpm'}")
    designed = run_design(
        LoadedSpec(path=Path("small"), sha256="", text=text, spec=parse_spec(text))
    )
    return [next(run_scenarios(designed, Runs(draw=seed))) for seed in range(count)]


def test_tissue_is_drawn_from_its_range():
    """The peak of the depth falls with the stiffness."""
    found = drawn(30)
    stiffness = np.array([one.parameters["soft k"] for one in found])
    assert 20 < stiffness.min() < 23
    assert 57 < stiffness.max() < 60
    peaks = np.array([one.metrics["peak_depth"] for one in found])[np.argsort(stiffness)]
    assert (np.diff(peaks) < 0).all()
    assert len({one.scenario.seed for one in found}) == 30


def test_the_motor_is_drawn_from_its_ranges():
    motor = "{nominal: 4.8417e-4 rad/s/rpm, range: [4.7e-4 rad/s/rpm, 5e-4 rad/s/rpm]}"
    found = drawn(20, motor=motor)
    gains = [one.parameters["motor gain"] for one in found]
    assert 4.7e-4 < min(gains) < 4.8e-4 < 4.9e-4 < max(gains) < 5e-4
    assert {one.parameters["motor time constant"] for one in found} == {0.0351}
    assert "motor gain" not in drawn(1)[0].parameters
