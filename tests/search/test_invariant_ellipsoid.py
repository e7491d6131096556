"""Bounds on the force for the robot of the thesis: known answers, and what they cover."""

from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest

from nrs_design.proof.channels import Channel, Output, Rounding
from nrs_design.proof.evidence import InvariantEllipsoid
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import first_accepted
from nrs_design.search.certify import Limits, certify
from nrs_design.search.family import floats_in_silence
from nrs_design.search.invariant_ellipsoid import search_ellipsoid, search_offset_ellipsoid
from nrs_design.search.work import Allowance, NotAffordableError
from nrs_design.simulation.worst_case import worst_runs
from tests.loop.support import assembled
from tests.proof.systems import (
    bouncing,
    bouncing_in_steps,
    dayawansa_martin,
    family,
    matrix,
    pushed,
)
from tests.search.support import thesis_robot
from tests.support import ROOT

SOFT, BOTH, INSERTION = ("41.5", "44.2"), ("2.15", "1.04"), ("2.15",)
slow = pytest.mark.slow
COMMAND = "{command: 8 deg/s}"
SAMPLED = {
    "sampling": "{period: 2 ms, delay: [0, 1]}",
    "disturbances": "{command: 8 deg/s, largest_angle: 20 deg}",
}
ENCODER = f"{{encoder_step: {360 / 8192 / 5:.10f} deg}}"


def bounded(system: SwitchedSystem) -> InvariantEllipsoid:
    """Return the first bound that the exact check accepts."""
    output = system.outputs[0]
    with floats_in_silence():
        search = search_ellipsoid(system, system.channels, output, Allowance())
        evidence, outcome = first_accepted(search, system)
    assert isinstance(evidence, InvariantEllipsoid), outcome
    return evidence


@pytest.mark.parametrize(
    ("k", "Bt", "Mt", "level", "speed"),
    [
        (("43", "43"), INSERTION, "0.01", 0.448, 5.4),
        pytest.param(SOFT, BOTH, "0.01", 1.12, 2.1, marks=pytest.mark.slow),
        (SOFT, BOTH, "0", 0.66, 3.6),
    ],
)
def test_the_command_that_keeps_the_limit_in_continuous_time(k, Bt, Mt, level, speed):
    """From a spec; found by an independent program, to two digits or three."""
    system = thesis_robot(k, Bt, Mt, contact="losable", disturbances="{command: 8 deg/s}")
    evidence = bounded(system)
    assert float(evidence.level) == pytest.approx(level, rel=0.02)
    kept = 8 * 0.3 / float(evidence.level)
    assert kept == pytest.approx(speed, abs=0.06)
    said = f"{np.floor(kept * pi / 180 * 1e4) / 1e4:.4f}"
    assert f"in proportion, for |velocity command| <= {said}" in evidence.claim(system)
    slow_command = replace(
        system, channels=(replace(system.channels[0], bound=Fraction(kept * pi / 180 * 0.999)),)
    )
    assert float(bounded(slow_command).level) < 0.3


@pytest.mark.parametrize(
    ("Bt", "disturbances", "level"),
    [
        (INSERTION, "{command: 8 deg/s}", 0.565),
        pytest.param(BOTH, ENCODER, 0.063, marks=slow),
        pytest.param(BOTH, "{friction: 55.3 rpm}", 0.319, marks=slow),
        pytest.param(BOTH, "{command: 8 deg/s}", 3.17, marks=slow),
    ],
)
def test_bounds_of_the_sampled_loop(Bt, disturbances, level):
    system = thesis_robot(
        SOFT,
        Bt,
        "0.01",
        sampling="{period: 2 ms, delay: 1}",
        contact="kept",
        disturbances=disturbances,
    )
    assert 0.95 * level < float(bounded(system).level) < 1.02 * level


@pytest.mark.parametrize(
    ("system", "kind"),
    [
        (bouncing(), "offset-ellipsoid"),
        (bouncing(1), "offset-ellipsoid"),
        (replace(bouncing(), contact=None), "invariant-ellipsoid"),
        (bouncing_in_steps(), "offset-ellipsoid"),
    ],
    ids=["bouncing", "lagging", "kept", "in steps"],
)
def test_a_bound_is_a_statement_beside_the_verdict(system, kind):
    found = certify(pushed(system), limits=Limits(optimize_rate=False))
    assert str(found.verdict) == "proved"
    kinds = [item.kind for item in found.statements]
    assert kinds[1:] == [kind]
    assert found.evidence is found.statements[0]
    assert found.attempts[-1].step == "bound on force under push"


def test_equal_modes_may_be_disturbed_unequally():
    """Two modes with one matrix are merged for stability; the bound sees both columns."""
    system = family([[-1]], [[-1]])
    columns = (matrix([[1]]), matrix([[3]]))
    outputs = (Output("z", "", (matrix([[1]]),)),)
    system = replace(system, channels=(Channel("d", "", Fraction(1), columns),), outputs=outputs)
    found = certify(system, limits=Limits(optimize_rate=False))
    assert float(found.statements[-1].level) > 3


def test_what_moves_nothing_is_not_called_beyond_floating_point():
    columns = (matrix([[0]]),)
    outputs = (Output("z", "", (matrix([[1]]),)),)
    system = replace(
        family([[-1]]), channels=(Channel("d", "", Fraction(1), columns),), outputs=outputs
    )
    found = certify(system, limits=Limits(optimize_rate=False))
    assert found.attempts[-1].outcome == "it moves nothing in any mode"


def test_nothing_is_found_where_no_quadratic_function_exists():
    """Stable, but by a polynomial only."""
    system = pushed(dayawansa_martin(6))
    with floats_in_silence():
        search = search_ellipsoid(system, system.channels, system.outputs[0], Allowance())
        evidence, why = first_accepted(search, system)
    assert evidence is None
    assert why


@pytest.mark.slow
def test_all_disturbances_at_once():
    """The bound on all is above each alone, and not far above their sum."""
    system = thesis_robot(
        SOFT,
        INSERTION,
        "0.01",
        sampling="{period: 2 ms, delay: 1}",
        contact="losable",
        disturbances="{friction: 55.3 rpm, force_step: 0.01 N*m, largest_angle: 20 deg}",
    )
    names = [channel.name for channel in system.channels]
    assert names[2:] == ["rounding of the reference", "rounding of the angle"]
    found = certify(system, limits=Limits(optimize_rate=False))
    bounds = [item for item in found.statements if isinstance(item, InvariantEllipsoid)]
    forces = {item.channels: float(item.level) for item in bounds if item.output == "force"}
    assert all(item.covers_rounding for item in found.statements)
    every, *alone = forces.values()
    assert len(alone) == 4
    assert max(alone) < every < 1.1 * sum(alone)
    # Angles that are off by 2^-24 of 20 degrees do next to nothing.
    assert forces["rounding of the angle",] < 1e-3
    claim = bounds[0].claim(system)
    assert "|friction| <= 55.3 rpm, |force error| <= 0.005 N*m, |rounding of the ref" in claim


def test_a_law_that_rounds_coarsely_is_bounded_without_its_roundings():
    """Where every term may be off by much, only exact arithmetic is covered, and it says so."""
    system = pushed(bouncing_in_steps())
    column, row = matrix([[1], [0]]), matrix([["1/2", 0, 0]])
    coarse = replace(system, roundings=(Rounding("v", (column,) * 3, (row,) * 3),))
    found = certify(coarse, limits=Limits(optimize_rate=False))
    assert str(found.verdict) == "proved"
    assert not any(item.covers_rounding for item in found.statements)
    assert all("computed without rounding" in item.claim(coarse) for item in found.statements)


def level(system: SwitchedSystem, search=search_offset_ellipsoid, work: float = 1e9) -> float:
    with floats_in_silence():
        candidates = search(system, system.channels, system.outputs[0], Allowance(work))
        item, why = first_accepted(candidates, system)
    assert item is not None, why
    assert item.covers_rounding is bool(system.roundings)
    return float(item.level)


@pytest.mark.parametrize(
    ("Bt", "Mt", "sections", "most", "ratio"),
    [
        (BOTH, "0.01", {"disturbances": COMMAND}, 0.89, 2.6),
        (BOTH, "0", {"disturbances": COMMAND}, 0.53, 1.6),
        (INSERTION, "0.01", {"disturbances": COMMAND}, 0.48, 1.4),
        (BOTH, "0.01", SAMPLED, 2.2, 5.8),
        (BOTH, "0", SAMPLED, 0.66, 2.0),
    ],
)
def test_levels_of_the_robot_of_the_thesis(Bt, Mt, sections, most, ratio):
    """With all roundings; an adversary reaches a share of it, on a surface in its place."""
    system = thesis_robot(SOFT, Bt, Mt, contact="losable", **sections)
    found = level(system)
    assert found < most
    (run,) = worst_runs(system, system.outputs[:1])
    assert 1 < found / run.value < ratio


@pytest.mark.slow
def test_levels_with_a_motor_that_is_known_to_two_percent():
    system = thesis_robot(SOFT, BOTH, "0.01", "0.02", contact="losable", **SAMPLED)
    assert level(system) < 2.9


@pytest.mark.parametrize(
    "system", [pushed(bouncing()), pushed(bouncing(1)), pushed(bouncing_in_steps())]
)
def test_hardly_ever_above_an_ellipsoid_around_the_origin(system):
    """It is one of those off the origin; what is claimed lies a percent above the least."""
    assert level(system) < 1.01 * level(system, search_ellipsoid)


def test_what_cannot_be_afforded_is_not_begun():
    system = pushed(bouncing_in_steps())
    with pytest.raises(NotAffordableError, match="33 unknowns and 39 blocks"):
        level(system, work=1e-3)


def test_nothing_is_found_where_a_mode_grows():
    """Who takes candidates says so."""
    system = pushed(bouncing_in_steps())
    grown = Mode("m0", matrix([["11/10", "-1/10"], ["1/10", 1]]))
    system = replace(system, modes=(grown, *system.modes[1:]))
    with floats_in_silence():
        search = search_offset_ellipsoid(system, system.channels, system.outputs[0], Allowance())
        with pytest.raises(np.linalg.LinAlgError, match="has no norm"):
            first_accepted(search, system)


def test_a_bound_at_an_unusual_share():
    """Most shares leave the solver nothing there; the best is a fiftieth of the largest."""
    system = assembled(ROOT / "tests" / "specs" / "far.yaml")
    search = search_ellipsoid(system, system.channels, system.outputs[0], Allowance())
    found, _ = first_accepted(search, system)
    assert found.level < Fraction("4.75")
