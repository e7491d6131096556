"""Adversaries below a safety layer: none leaves what is proved, and some come near it."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.replica import step
from nrs_design.controllers.safety import SafetyLimits
from nrs_design.proof.evidence import SafetyLayer
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.safety_layer import search_safety
from tests.proof.systems import governed as small
from tests.simulation.safe import LIMITS, PERIOD, STIFFNESS, governed, law_of, run

SOFT, STIFF = map(float, STIFFNESS)
COUNT, SAMPLES = 40, 600


@cache
def proved(
    oldest: int, damping: Fraction = Fraction(0), limits: SafetyLimits = LIMITS
) -> SafetyLayer:
    loop = governed(oldest, limits, damping=damping)
    system: SwitchedSystem = replace(small(), sample_time=PERIOD, safety=loop)
    evidence = next(search_safety(system)).evidence
    assert evidence.find_fault(system) is None
    return evidence


def still(plants):
    return np.full(len(plants.surface), np.nan)


def wild(k, plants, seen, rng):
    """Everything at random: modes, hand, velocity of the admittance, stiffness."""
    n = len(seen)
    velocity = np.where(rng.random(n) < 0.3, rng.uniform(-5, 5, n), np.nan)
    return rng.integers(0, 2, n), rng.uniform(-9, 9, n), velocity, rng.choice([SOFT, STIFF], n)


def pushing(k, plants, seen, rng):
    """Inward as fast as it goes; soft until the torque is felt, then stiff."""
    inward = np.sign(plants.surface)
    return np.ones(len(seen), int), 9 * inward, -50 * inward, np.full(len(seen), SOFT)


def swinging(k, plants, seen, rng):
    """In and out with periods around that of the motion loop."""
    periods = np.linspace(5, 60, len(seen))
    way = np.sign(np.sin(np.pi * k / periods)) * np.sign(plants.surface)
    return np.ones(len(seen), int), 0 * way, -50 * way, np.full(len(seen), SOFT)


def pumping(k, plants, seen, rng):
    """Stiff on the way in and soft on the way out, under an admittance that is not stable."""
    inward = np.sign(plants.surface)
    velocity = -0.15 * inward if k < 150 else still(plants)
    stiffness = np.where(inward * plants.omega > 0, STIFF, SOFT)
    return np.zeros(len(seen), int), 0 * seen, velocity, stiffness


def worst_window(work):
    """Return the most that any samples in a row add up to, of every run."""
    total = np.vstack([np.zeros(work.shape[1]), np.cumsum(work, axis=0)])
    return (total - np.minimum.accumulate(total, axis=0)).max(axis=0)


@pytest.mark.parametrize("oldest", [0, 1, 3])
@pytest.mark.parametrize("adversary", [wild, pushing, swinging, pumping])
def test_no_adversary_leaves_what_is_proved(adversary, oldest):
    most = proved(oldest).limits
    found = run(law_of(), adversary, COUNT, SAMPLES, seed=oldest, oldest=oldest)
    assert found.speed.max() <= float(most.velocity)
    assert found.torque.max() <= float(most.torque)
    assert found.error.max() <= float(most.error)
    assert found.command.max() <= float(most.command)
    spent = float(LIMITS.energy) + SAMPLES * float(LIMITS.refill + most.lost)
    assert worst_window(found.work).max() <= spent
    assert found.withheld.any()


def test_the_bounds_are_not_far_from_what_is_found():
    """Ratios of the worst that was found to what is proved."""
    most = proved(1).limits
    found = [run(law_of(), one, COUNT, SAMPLES, seed=1) for one in (pushing, swinging)]
    assert max(one.speed.max() for one in found) > 0.9 * float(most.velocity)
    assert max(one.torque.max() for one in found) > 0.85 * float(most.torque)
    assert max(one.error.max() for one in found) > 0.9 * float(most.error)


@pytest.mark.parametrize("adversary", [wild, pushing, swinging])
def test_nor_where_the_tissue_damps(adversary):
    most = proved(1, Fraction(1, 2)).limits
    found = run(law_of(), adversary, COUNT, SAMPLES, seed=5, damping=0.5)
    assert 0.3 * float(most.torque) < found.torque.max() <= float(most.torque)
    assert found.speed.max() <= float(most.velocity)


def test_the_work_of_the_reference_comes_to_its_limit_and_not_beyond():
    tight = replace(LIMITS, energy=to_float32(Fraction(1, 2000)), refill=Fraction(0))
    law = law_of(limits=tight)
    spent = float(tight.energy) + 300 * float(proved(1).limits.lost)
    for adversary in (pushing, swinging):
        work = worst_window(run(law, adversary, COUNT, 300, seed=1).work).max()
        assert 0.95 * float(tight.energy) < work <= spent


def test_the_work_of_a_reference_that_is_rounded_counts():
    """Half a unit in the last place is booked, and the reference goes on by a whole one."""
    small = replace(LIMITS, energy=to_float32(Fraction(1, 10**5)), refill=Fraction(0))
    law, unit, torque = law_of(limits=small), 2.0**-22, np.full(1, 0.299, np.float32)
    states = {s.name: np.zeros(1, np.float32) for s in law.states}
    states["reference"] += np.float32(2.5)
    work, count = 0.0, 400
    for k in range(count):
        hand = np.array([(0.52, -0.48)[k % 2] * unit / float(PERIOD)], np.float32)
        states["velocity"] *= 0
        given = {"angle": states["reference"], "torque": torque, "velocity_command": hand}
        done = step(law, np.zeros(1, np.uint32), {**given, **states})
        work += float(torque[0]) * float(done.states["reference"][0] - states["reference"][0])
        states = dict(done.states)
    lost = proved(1, limits=small).limits.lost
    products = 2 * Fraction(1, 2**22) * small.energy
    assert float(small.energy + count * products) < work <= float(small.energy + count * lost)


def test_without_the_layer_the_same_adversary_leaves_them():
    most = proved(1).limits
    found = run(law_of(layer=False), wild, COUNT, 300, seed=1)
    assert found.speed.max() > 2 * float(most.velocity)
    assert found.torque.max() > 2 * float(most.torque)


def test_at_a_constant_stiffness_the_torque_stays_below_the_sharper_bound():
    most = proved(1).limits
    for stiffness in (SOFT, STIFF):

        def press(k, plants, seen, rng, stiffness=stiffness):
            inward = np.sign(plants.surface)
            return np.ones(len(seen), int), 9 * inward, -50 * inward, np.full(len(seen), stiffness)

        press.constant = True
        found = run(law_of(), press, COUNT, SAMPLES, seed=2, start=stiffness)
        assert found.torque.max() <= float(most.steady) < float(most.torque)
        stored = (found.torque**2 / (2 * stiffness)).max()
        assert 0.3 * float(most.stored) < stored <= float(most.stored)


def test_a_stable_law_is_not_touched_by_the_layer():
    """An admissible run of the stiff admittance: slow commands, torque below the limit."""

    def gentle(k, plants, seen, rng):
        hand = 0.1 * np.sin(2e-3 * k * np.arange(1, len(seen) + 1))
        return np.ones(len(seen), int), hand, still(plants), np.full(len(seen), 43.0)

    layer = run(law_of(), gentle, COUNT, SAMPLES, seed=3)
    bare = run(law_of(layer=False), gentle, COUNT, SAMPLES, seed=3)
    assert not layer.withheld.any()
    assert layer.torque.max() > 0.05
    for name in ("speed", "torque", "error", "command", "work"):
        assert np.array_equal(getattr(layer, name), getattr(bare, name)), name
