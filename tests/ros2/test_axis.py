"""One axis of the controller against its steps, written as the controller takes them."""

import math
import random
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.ros2.axis import axis_damping, close_axis, square_root_between
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from tests.ros2.support import around, axis, law

F = Fraction


class Robot:
    """The controller and its robot, step by step in floating point.

    In the order of `AdmittanceRule::update` (ros2_controllers): measure, smooth, accelerate,
    integrate speed and then offset.
    """

    def __init__(self, one, damping, c, period, lag, oldest):
        self.M, self.K = float(one.mass), float(one.stiffness)
        self.D = float(one.damping_ratio) * 2 * math.sqrt(self.M * self.K)
        self.damping, self.c, self.T = float(damping), float(c), float(period)
        self.keep = math.exp(-self.T / lag) if lag else 0.0
        self.speed = self.offset = self.force = self.place = 0.0
        self.before = [0.0] * (oldest + 1)

    def step(self, age, k):
        x = self.before[age]
        self.force = self.c * (-k * x) + (1 - self.c) * self.force
        acceleration = (self.force - self.D * self.speed - self.K * x) / self.M
        acceleration -= self.damping * self.speed
        self.speed += acceleration * self.T
        self.offset += self.speed * self.T
        self.place = self.keep * self.place + (1 - self.keep) * self.offset
        self.before = [self.place, *self.before[:-1]]


def state_of(robot, frame_states):
    """The state of the proof, from the history of the robot."""
    steps = [a - b for a, b in zip(robot.before, robot.before[1:], strict=False)]
    values = {"v": robot.speed, "e": robot.offset - robot.place, "f": robot.force}
    values["delta"] = robot.before[-1]
    values |= {f"step {i} before": step for i, step in enumerate(steps)}
    return [values[name.partition(" [")[0]] for name in frame_states]


@pytest.mark.parametrize("seed", range(40))
def test_the_map_is_the_step_of_the_controller(seed):
    draw = random.Random(seed)
    c = draw.choice(["0.05", "0.5", "1"])
    oldest = draw.randrange(4)
    first = draw.randrange(oldest + 1)
    lag = draw.choice([0.0, 0.004, 0.03])
    one = axis("5.5", "0.7", draw.choice(["0", "214.1"]))
    k = F(draw.randrange(100, 3000))
    place = around("0.002", (first, oldest), (k, k), (lag, lag))
    system = close_axis(law(one, "5", c), one, place)
    robot = Robot(one, 5, F(c), F("0.002"), lag, oldest)
    robot.speed, robot.place, robot.offset = 0.3, 0.01, 0.02 if lag else 0.01
    robot.before = [0.01] + [draw.uniform(-0.01, 0.01) for _ in range(oldest)]
    by_age = {}
    for mode in system.modes:
        by_age.setdefault(mode.name.partition("age-")[2].partition("/")[0], mode)
    for _ in range(30):
        age = draw.randint(first, oldest)
        A = by_age[str(age) if first < oldest else ""].A
        before = state_of(robot, system.states)
        robot.step(age, float(k))
        after = [sum(a * x for a, x in zip(row, before, strict=True)) for row in A.floats()]
        assert after == pytest.approx(state_of(robot, system.states), rel=1e-9, abs=1e-12)


@given(st.fractions(0, 10**6, max_denominator=10**6))
def test_a_square_root_lies_between(value):
    found = square_root_between(value)
    assert found.low**2 <= value <= found.high**2
    assert found.high - found.low <= F(1, 2**80)


def test_a_rational_damping_is_a_point():
    found = axis_damping(axis("2", "1.5", "8"))
    assert found.low == found.high == 12
    found = axis_damping(axis("2", "-1.5", "7"))
    assert found.low < found.high < 0


def verdict(one, damping, c, place):
    found = certify(close_axis(law(one, damping, c), one, place), limits=Limits(budget=10))
    return str(found.verdict), found.evidence


@pytest.mark.parametrize("Bt", ["2.15", "1.04"])
def test_a_pure_admittance_in_soft_tissue(Bt):
    """Mt = 0.01, Bt as joint damping Bt/Mt (thesis 6.3.2); steps well beyond 2 Mt/Bt end it."""
    one = axis("0.01", "0", "0", rotates=True)
    damping = F(Bt) / F("0.01")
    place = around("0.002", (1, 1), ("41.5", "44.2"))
    found, evidence = verdict(one, damping, "0.5", place)
    assert found == "proved"
    assert evidence.covers_lost_contact
    too_long = 4 / damping
    found, _ = verdict(one, damping, "0.5", around(too_long, (1, 1), ("41.5", "44.2")))
    assert found == "refuted"


def test_the_default_filter_against_a_robot_that_lags():
    """The default 0.05 smooths over 20 periods: with a robot that lags it is too slow."""
    one, damping = axis("0.01", "0", "0", rotates=True), F(104)
    place = around("0.002", (0, 0), ("41.5", "44.2"), ("0.04", "0.04"))
    assert verdict(one, damping, "0.05", place)[0] == "refuted"
    assert verdict(one, damping, "0.5", place)[0] == "proved"


def test_an_axis_without_force():
    one = axis("5", "1", "200", selected=False)
    system = close_axis(law(one, "5", "0.05"), one, around("0.002", (0, 1), ("0", "0")))
    assert all("f [" not in state for state in system.states)
    alone = axis("5", "1", "0", selected=False)
    system = close_axis(law(alone, "5", "0.05"), alone, around("0.002", (0, 1), ("0", "0")))
    assert system.states == ("v [m/s]",)
    assert len(system.modes) == 1
