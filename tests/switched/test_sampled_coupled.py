"""All axes at once in the sampled loop: bounds of a period, and runs by the equations of motion.

Between samples, every run here follows ``z' = -Lambda D z - (Lambda/J) (C omega + G delta)`` with
full matrices that change while a command is held, at their bounds.
"""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import exp

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import AssemblyError
from nrs_design.models.interval import Interval
from nrs_design.search.certify import Limits, certify
from nrs_design.switched.coupled import AxesCoupling
from nrs_design.switched.sampled_coupled import pushes
from tests.proof.graphs import shape_of
from tests.search.support import thesis_robot
from tests.switched.test_coupled import rotation

J, TAU, T = Fraction("1.213"), Fraction("0.0351"), Fraction("0.002")
LINKS = AxesCoupling(J, Fraction("0.0037"), Fraction("0.29"), Fraction("0.1"), "14 deg/s")
LEANING = replace(LINKS, gravity_gradient=Fraction(7))
WIDE = replace(LEANING, heaviest=Fraction(3), coriolis=Fraction(20), gravity_gradient=Fraction(900))
KNOWN = Interval.point(TAU)
RANGED = Interval(TAU, TAU * Fraction("0.9"), TAU * Fraction("1.1"))
PARTS = 8


def links(generator, coupling, extreme):
    """Return Lambda with eigenvalues at the ends of its range; all of them there, if extreme."""
    low, high = map(float, coupling.shares)
    V = rotation(generator)
    middle = generator.choice([low, high]) if extreme else generator.uniform(low, high)
    return V @ np.diag([low, high, middle]) @ V.T


def period(generator, coupling, taus, speed, deflection, command):
    """Return speed and deflection after a period under a held speed that motors come to."""
    D, N = np.diag(1 / taus), len(taus)
    C, G = (
        rotation(generator) * float(size or 0) / float(coupling.drive)
        for size in (coupling.coriolis, coupling.gravity_gradient)
    )
    one = np.eye(N)
    for _ in range(PARTS):
        L = links(generator, coupling, extreme=bool(generator.integers(2)))
        # Of speed, deflection and the command.
        A = np.block([[-L @ D - L @ C, -L @ G, L @ D], [one, 0 * one, 0 * one], [0 * one] * 3])
        moved = expm(A * float(T) / PARTS) @ np.concatenate([speed, deflection, command])
        speed, deflection = moved[:N], moved[N : 2 * N]
    return speed, deflection


def alone(coupling, taus, speed, deflection, command):
    """Return the same with links of the middle weight, for each axis by itself."""
    s = float((sum(coupling.shares) / 2).limit_denominator(1000))
    E = np.exp(-s * float(T) / taus)
    way = taus / s * (1 - E) * (speed - command) + float(T) * command
    return command + E * (speed - command), deflection + way


@pytest.mark.parametrize("coupling", [LINKS, LEANING, WIDE])
@pytest.mark.parametrize("tau", [KNOWN, RANGED])
@pytest.mark.parametrize("seed", range(12))
def test_no_period_goes_beyond_its_bound(coupling, tau, seed):
    generator = np.random.default_rng(seed)
    taus = generator.choice([float(tau.low), float(tau.high)], size=3)
    speed, deflection, command = generator.standard_normal((3, 3)) * [[1], [0.1], [1]]
    given = taus, speed, deflection, command
    found = zip(period(generator, coupling, *given), alone(coupling, *given), strict=True)
    signals = [np.linalg.norm(part) for part in (speed - command, speed, deflection)]
    for (here, there), push in zip(found, pushes(coupling, tau, T), strict=True):
        sizes = [float(part) for part in (push.slip, push.speed, push.deflection)]
        assert np.linalg.norm(here - there) <= np.dot(sizes, signals)


def test_the_bound_of_the_inertia_is_near():
    """All links light: ``exp(-u T/tau)`` in the place of ``exp(-s T/tau)``."""
    still = replace(LINKS, coriolis=None, speed=None)
    on_speed, on_way = pushes(still, KNOWN, T)
    low, high = map(float, still.shares)
    s, turn = float((sum(still.shares) / 2).limit_denominator(1000)), float(T / TAU)
    found = max(abs(exp(-share * turn) - exp(-s * turn)) for share in (low, high))
    assert 0.97 < found / float(on_speed.slip) < 1
    assert on_speed.speed == on_speed.deflection == on_way.speed == 0


def test_the_bounds_by_hand():
    """J = 1, M from 0 to 1, tau = 1 and T = 1/10: Lambda in [1/2, 1], s = 3/4, r = 1/4."""
    one = Fraction(1)
    coupling = AxesCoupling(one, Fraction(0), one)
    on_speed, on_way = pushes(coupling, Interval.point(one), one / 10)
    assert float(on_speed.slip) == pytest.approx(0.25 * 0.1 / 1.05, rel=1e-5)
    assert float(on_way.slip) == pytest.approx(0.25 * 0.01 / 2, rel=1e-5)
    moving = replace(coupling, coriolis=Fraction(2))
    on_speed, _ = pushes(moving, Interval.point(one), one / 10)
    left, share = 1 - 2 * 0.1 * 1.1, 1 + 0.25 * 0.1 / 2
    assert float(on_speed.speed) == pytest.approx(0.1 * share * 2 / left, rel=1e-5)
    slipping = 0.25 * 0.1 / 1.05 + 0.1 * share * 2 * 0.1 / left
    assert float(on_speed.slip) == pytest.approx(slipping, rel=1e-5)


def test_a_period_that_is_too_long():
    fast = replace(LINKS, coriolis=Fraction(10**5))
    with pytest.raises(AssemblyError, match="a period is too long"):
        pushes(fast, KNOWN, T)


@cache
def axes(*Bt, delay="[0, 1]", contact="losable", tolerance="0", **more):
    links = "{inertia: [0.0037 kg*m^2, 0.29 kg*m^2], coriolis: 0.1 N*m*s/rad, speed: 14 deg/s"
    links += ", axes: 3}"
    sections = {"sampling": f"{{period: 2 ms, delay: {delay}}}", "coupling": links}
    sections |= {"contact": contact} | more
    k = ("41.5", "44.2")
    return thesis_robot(k, Bt, "0.01", tolerance, load="1.213", **sections)


@cache
def proof(*Bt, **sections):
    found = certify(axes(*Bt, **sections), limits=Limits(optimize_rate=False))
    assert found.verdict is Verdict.PROVED
    return found


def test_both_controllers_are_proved_with_rounding_and_loss_of_contact():
    found = proof("2.15", "1.5")
    assert shape_of(found.evidence) == "coupled-axes"
    assert found.evidence.covers_rounding
    claim = found.evidence.claim(found.system)
    assert claim.startswith("For any number of axes that act on each other")
    assert "contact lost and made again at any time" in claim
    assert "rho^t |w(0)|" in claim
    text = " ".join(found.system.assumptions)
    assert "All axes are sampled at the same moments" in text
    assert "The axes do not act on each other" not in text


def test_disturbances_may_take_the_speed_beyond_what_is_declared():
    """A command of 8 deg/s that reverses on three axes is beyond 14 deg/s, and nothing bars it."""
    quiet, pushed = (
        " ".join(axes("2.15", contact="kept", **more).assumptions)
        for more in ({}, {"disturbances": "{command: 8 deg/s}"})
    )
    assert "the speed stays below 14 deg/s, which is not shown." in quiet
    assert "which is not shown, nor that the disturbances leave it there: a bound" in pushed


def test_gravity_needs_contact_that_is_kept():
    with pytest.raises(AssemblyError, match="where contact is kept"):
        axes("2.15", coupling=GRAVE)
    names = [part.name for part in axes("2.15", contact="kept", coupling=GRAVE).couplings]
    assert names[-2:] == ["gravity on the speed", "gravity on the way"]


GRAVE = "{inertia: [0 kg*m^2, 0.29 kg*m^2], gravity_gradient: 7 N*m/rad, axes: 3}"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1))
def test_ten_thousand_steps_of_three_axes(seed):
    """V falls at its rate at every step, whatever modes the axes are in, and what links do."""
    found, generator = proof("2.15", "1.5"), np.random.default_rng(seed)
    system, item = found.system, found.evidence
    Q = np.array(item.nodes[0].form, dtype=float) / 2.0**item.denominator_log2
    states, keeps = system.states, float(item.rate) ** 2 * (1 + 1e-9)
    omega, taus = states.index("omega [rad/s]"), np.full(3, float(TAU))
    contact, free = (
        [np.array(mode.A.floats()) for mode in part] for part in (system.modes, system.contact.free)
    )
    n = len(states)
    x = np.zeros((3, n))
    size = float(pushes(LINKS, KNOWN, T)[0].slip)
    for step in range(10_000):
        if step % 25 == 0:
            x = generator.standard_normal((3, n)) / np.sqrt(np.diag(Q))
        before = value(x, Q)
        picks = [
            generator.integers(len(contact))
            if row[-1] > 0
            else len(contact) + generator.integers(len(free))
            for row in x
        ]
        maps = [(contact + free)[k] for k in picks]
        following = np.array([A @ row for A, row in zip(maps, x, strict=True)])
        rows = [np.array(system.couplings[0].rows[k].floats()[0][:n]) / size for k in picks]
        z = np.array([row @ own for row, own in zip(rows, x, strict=True)])
        given = taus, x[:, omega], x[:, -1], x[:, omega] - z
        there = alone(LINKS, *given)
        moved = period(generator, LINKS, *given)
        for column, here, own in zip((omega, -1), moved, there, strict=True):
            following[:, column] += here - own
            if column == -1:
                following[:, 0] -= here - own
        x = following
        assert value(x, Q) <= keeps * before


def value(x, Q):
    w = x.copy()
    w[:, -1] = np.maximum(w[:, -1], 0.0)
    return np.einsum("ai,ij,aj", w, Q, w)
