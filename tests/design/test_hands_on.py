"""What a hand feels: transparency and effort, against the responses themselves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.design.goals import ContactCorner, Requirement
from nrs_design.design.loops import Loops, hand_effort, transparency
from nrs_design.design.measures import HAND_EFFORT, TRANSPARENCY
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import Elastic, Hand, KelvinVoigt
from tests.design.motion_loops import PLACE, axis_with
from tests.support import ROOT, document_of, run

HANDS_ON = ROOT / "docs/examples/hands-on.nrs.yaml"
# G of the thesis, 6.1, and an ideal one.
MOTION = TransferFunction((0.99, 56.82), (0.0351, 1.997, 56.82))
BAND = 4 * np.pi


def by_grid(k, b, Mt, Bt, m=0):
    """Both measures by their responses, on a fine grid that leaves out zero."""
    s = 1j * np.linspace(1e-6, BAND, 5_001)
    G = np.polyval(MOTION.numerator, s) / np.polyval(MOTION.denominator, s)
    Ze = k / s + b + m * s
    L = G * Ze / (Mt * s + Bt)
    return np.abs(L / (1 + L)).min(), np.abs(Ze / (1 + L)).max()


def held_by(hand):
    corner = ContactCorner("hand", "hand", hand, PLACE, True)
    return Requirement(axis_with(MOTION), (corner,), bandwidth=BAND)


def hundredths(low, high):
    return st.integers(low, high).map(lambda n: n / 100)


@settings(max_examples=40)
@given(
    hundredths(2500, 9040),
    hundredths(0, 50),
    st.one_of(st.just(0), hundredths(1, 20)),
    hundredths(0, 300),
    hundredths(400, 800),
)
def test_against_the_responses(k, b, m, Mt, Bt):
    """Hands of the thesis, and admittances as in table 7.1, all of which they leave stable."""
    if m:
        Mt = 2.0
    requirement = held_by(Hand(k, b, m) if m else KelvinVoigt(k, b))
    lowest, highest = by_grid(k, b, Mt, Bt, m)
    gains = np.array([Mt]), np.array([Bt])
    assert requirement.values(TRANSPARENCY, *gains)[0][0] == pytest.approx(lowest, rel=1e-4)
    assert requirement.values(HAND_EFFORT, *gains)[0][0] == pytest.approx(highest, rel=1e-4)


def test_steady_motion_takes_the_damping():
    """At rest L is infinite: the hand applies Bt/G(0) per velocity, and the robot follows."""
    loops = Loops(np.array([[0.0, 0.0, 50.0]]), np.array([[1.0, 8.0, 0.0]]))
    assert hand_effort(loops, Elastic(50.0), 1e-9) == pytest.approx([8.0])
    assert transparency(loops, 1e-9) == pytest.approx([1.0])


def test_a_spring_is_held_for_ever():
    """With Y = s/(Mt s^2 + Bt s + Kt) no effort is enough for a lasting velocity."""
    loops = Loops(np.array([[0.0, 0.0, 50.0]]), np.array([[1.0, 8.0, 10.0]]))
    assert hand_effort(loops, Elastic(50.0), BAND)[0] == np.inf
    assert transparency(loops, 1e-9) == pytest.approx([50 / 60])


def test_unstable_is_the_worst():
    loops = Loops(np.array([[0.0, 0.0, 50.0]]), np.array([[1.0, -8.0, 0.0]]))
    assert hand_effort(loops, Elastic(50.0), BAND)[0] == np.inf
    assert transparency(loops, BAND)[0] == 0.0


def table(mass, damping):
    """The example with an admittance of table 7.1."""
    text = HANDS_ON.read_text().replace("{min: 0.1 kg*m^2, max: 3 kg*m^2}", f"{mass} kg*m^2")
    text = text.replace("{min: 1 kg*m^2/s, max: 20 kg*m^2/s}", f"{damping} kg*m^2/s")
    return text.replace("contact: losable", "contact: kept")


@pytest.mark.slow
def test_the_lightest_admittance_of_table_7_1_misses_the_goals_of_a_hand(tmp_path):
    """Those that are designed meet them, as the recorded answer of `optimize` says."""
    (tmp_path / "table.nrs.yaml").write_text(table(1, 4))
    missed = run("optimize", "table.nrs.yaml", cwd=tmp_path, code=1)
    assert "effort of the hand" in missed.stdout
    assert "MISSED" in missed.stdout


@pytest.mark.parametrize(("mass", "damping", "code"), [(1, 8, 0), (2, 4, 1)])
def test_admittances_of_table_7_1_and_a_hand_that_changes_its_grip(tmp_path, mass, damping, code):
    """Each is stable for every constant hand; one with less damping is pumped by its changes."""
    (tmp_path / "table.nrs.yaml").write_text(table(mass, damping))
    result = run(
        "certify-switching", "table.nrs.yaml", "--out", "ours.json", cwd=tmp_path, code=code
    )
    assert ("Repeating the signal" in result.stdout) == (code == 1)


def test_a_spring_in_the_admittance(tmp_path):
    """Kt of 5 N m/rad beside a hand of 25: at rest it gives way by 25/30; the proof takes it up."""
    damping = "4.6 kg*m^2/s"
    text = table("0.1", "4.6").replace(damping, f"{damping}\n    Kt: 5 N*m/rad")
    (tmp_path / "spring.nrs.yaml").write_text(text)
    (light,) = document_of("optimize", "spring.nrs.yaml", cwd=tmp_path, code=1)["controllers"]
    goals = {item["goal"]: item for item in light["goals"]}
    assert goals["max_hand_effort"]["worst"] is None
    assert goals["min_transparency"]["worst"] < 24.9984 / 29.9984
    run("certify-switching", "spring.nrs.yaml", "--out", "o.json", cwd=tmp_path, code=0)
