"""Limits of contact with people: judged by bounds that are proved, or not at all."""

from dataclasses import dataclass
from fractions import Fraction

import pytest

from nrs_design.certificates import people
from nrs_design.certificates.people import certified_speed, contact_goals
from nrs_design.models.impact import Impact
from nrs_design.proof.mode import Time
from nrs_design.spec import parse_spec
from tests.support import SOFT_TISSUE

F = Fraction
TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
DISTURBED = "\ndisturbances: {command: 8 deg/s}\n"
REGION = (
    "name: hand, source: an example, lever_arm: {min: 0.2 m, max: 0.4 m}, environment: soft, "
    "robot_mass: 3 kg, body_mass: 0.6 kg, stiffness: 75 N/mm"
)


@dataclass(frozen=True)
class Level:
    level: Fraction
    channels: tuple = ()


@dataclass(frozen=True)
class Shown:
    """What a certificate would show: a bound on the force, and one on the velocity."""

    losable: bool = True
    statements: tuple = ()

    @property
    def system(self):
        return self

    @property
    def is_losable(self):
        return self.losable

    time = Time.DISCRETE


@pytest.fixture
def bounded(monkeypatch):
    levels = {"force": F(3), "velocity": F(1, 2)}
    monkeypatch.setattr(people, "bound_on", lambda *given: Level(levels[given[-1]]))
    return Shown()


def spec_of(limits, more=DISTURBED):
    area = ", contact_area: 2 cm^2" if "pressure" in limits else ""
    written = f"  bandwidth: 2 Hz\n  contact: [{{{REGION}, {limits}{area}}}]\n"
    return parse_spec(TEXT.replace("  bandwidth: 2 Hz\n", written) + more)


def judged(certificate, limits, **others):
    (goal,) = contact_goals(spec_of(limits, **others), certificate)
    return goal


IMPACT = Impact(F(3), F("0.6"), F(75_000))
# Force at the shortest arm, speed at the longest: 15 N and 0.2 m/s.
SPEED = F(1, 5)


@pytest.mark.parametrize(
    ("key", "unit", "edge"),
    [
        ("quasi_static_force", "N", F(15)),
        ("quasi_static_pressure", "N/cm^2", F(15) / 2),
        ("speed", "m/s", SPEED),
        ("energy", "J", IMPACT.energy(SPEED)),
        ("transient_force", "N", IMPACT.force(SPEED)),
        ("transient_pressure", "N/cm^2", IMPACT.force(SPEED) / 2),
        ("hic", "", IMPACT.hic(SPEED)),
    ],
)
def test_a_limit_is_met_from_what_is_proved_on(bounded, key, unit, edge):
    for share, met in ((F(1001, 1000), True), (F(999, 1000), False)):
        number = f"{float(edge * share):.12g} {unit}".strip()
        assert judged(bounded, f"{key}: {number}").met is met
    said = judged(bounded, f"{key}: {number}").said
    assert "[an example]" in said
    assert "from rest" in said


def test_a_region_that_moves_adds_its_speed(bounded):
    assert judged(bounded, "speed: 0.3001 m/s, body_speed: 0.1 m/s").met
    assert not judged(bounded, "speed: 0.2999 m/s, body_speed: 0.1 m/s").met


@pytest.mark.parametrize(
    ("certificate", "more", "words"),
    [
        (None, DISTURBED, "no bound on the velocity was proved"),
        (Shown(), "", "no command is declared"),
        (Shown(losable=False), DISTURBED, "that of kept contact"),
        (
            Shown(),
            DISTURBED + "sampling: {period: 2 ms, delay: 0, latency: 1 ms}\n",
            "within a period",
        ),
    ],
)
def test_without_a_bound_that_counts_nothing_is_judged(bounded, certificate, more, words):
    goal = judged(certificate, "speed: 100 m/s", more=more)
    assert not goal.met
    assert goal.said.startswith("not judged: ")
    assert words in goal.said


def test_a_safety_layer_bounds_the_speed_whatever_is_commanded(monkeypatch):
    from tests.proof.systems import genuine

    _, layer = genuine("safety-layer")
    found = certified_speed(spec_of("speed: 1 m/s", ""), Shown(statements=(layer,)))
    assert found.level == layer.limits.velocity
    assert "whatever is commanded" in found.under


def test_without_regions_there_is_nothing_to_judge(bounded):
    assert [*contact_goals(parse_spec(TEXT + DISTURBED), bounded)] == []
