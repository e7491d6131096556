"""The cheapest gains of all, with those of the motion loop and a spring among them."""

from dataclasses import replace
from fractions import Fraction
from math import log

import numpy as np
import pytest

from nrs_design.controllers.float32 import exact_decimal, round_float32
from nrs_design.controllers.gains import apply_free_gains, design_from_gains, gains_of
from nrs_design.design.analysis import design_controllers
from nrs_design.design.impedance_optimum import optimize_impedance
from nrs_design.design.laws.impedance import impedance_problem, requirement_of
from nrs_design.design.laws.law import Task
from nrs_design.errors import CertificateError
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.free_gains import gain_branches
from nrs_design.spec import parse_spec
from nrs_design.spec.build_plant import build_plant
from tests.support import SOFT_TISSUE, replaced

from .free import FORCE, PD, freed

MASS = ("Mt: {min: 0.01 kg*m^2, max: 1 kg*m^2}", "Mt: 0.01 kg*m^2")


def anywhere(Mt, Bt):
    return np.ones(len(Mt), dtype=bool)


def branch(designed):
    (gains,) = gain_branches(designed, run_analysis(designed))
    return gains


def test_the_least_cost_is_at_a_corner_of_the_motion_gains():
    """By the search of one controller at each corner, which is global in Mt and Bt.

    Nothing in the cost holds the motion gains back: it has neither noise nor effort.
    """
    designed = freed(PD, MASS)
    gains = branch(designed)
    x = gains.optimum()
    motion, least = designed.design.motion, {}
    for Kp in (0.6, 1, 1.6):
        for Kd in (0.6, 1, 1.6):
            pd = type(motion)(motion.Kp * round(10 * Kp) / 10, motion.Kd * round(10 * Kd) / 10)
            task, cost = Task(designed.spec, designed.plant, pd), 0.0
            for given in designed.spec.controllers.values():
                requirement = requirement_of(task, given)
                problem = impedance_problem(task, given, requirement)
                cost += optimize_impedance(replace(problem, stable=anywhere)).cost
            least[Kp, Kd] = cost
    assert min(least, key=least.get) == (1.6, 0.6)
    assert gains.cost(x) == pytest.approx(least[1.6, 0.6], abs=2e-5)
    assert gains.at_bounds(x) == (("motion Kp", "upper"), ("motion Kd", "lower"))


def test_a_recheck_takes_freed_gains_within_their_factors():
    designed = freed(PD, MASS)
    gains = branch(designed)
    one = next(iter(gains.roundings(gains.optimum())))
    own = gains.shipping(one, one.x)
    assert "motion Kp = " in gains.said(one.x)
    texts = gains_of(own)
    assert design_from_gains(designed.spec, texts) == own
    texts["motion"]["Kp"] = str(2 * int(designed.design.motion.Kp))
    with pytest.raises(CertificateError, match="Kp of motion is outside its bounds"):
        design_from_gains(designed.spec, texts)


def test_goals_of_a_force_controller_hold_beside():
    goal = ("contact: losable\ngoals: {", "contact: losable\ngoals: {min_phase_margin: 45 deg, ")
    own = ("    goals: {max_force_error: 0.55}\n", "")
    designed = freed("force: {Kp: {min: 0.25, max: 10}}", goal, own, path=FORCE)
    gains = branch(designed)
    # It is the gain that is given, as no cost says better.
    assert gains.optimum() == pytest.approx([log(0.02)])
    spared = [float(gains.spared(np.array([log(0.02 * f)]))[0]) for f in (0.25, 1, 10)]
    assert spared == sorted(spared, reverse=True)
    assert spared[0] > 0 > spared[-1]


def test_a_spring_moves_the_cost():
    spring = ("type: impedance\n", "type: impedance\n    Kt: 2 N*m/rad\n")
    kept = ("contact: losable", "contact: kept")
    designed = freed("insertion: {Kt: {min: 0.5, max: 2}}", spring, MASS, kept)
    gains = branch(designed)
    free = gains.optimum()
    # The desired impedance has no spring.
    assert dict(gains.at_bounds(free)) == {"insertion Kt": "lower"}
    here = free.copy()
    here[[one.gain for one in gains.coordinates].index("Kt")] = log(2)
    assert gains.cost(free) < gains.cost(here)
    assert float(gains.design(free).laws["insertion"].gains["Kt"]) == pytest.approx(1)


@pytest.mark.parametrize(("factor", "fits"), [("1", True), ("1.04", True), ("3", False)])
def test_recorded_gains_are_as_near_as_the_spec_says(factor, fits):
    """Also where the root locus gives what is free, and the spec gives neither gain."""
    lines = ("  derivative_gain: 2060 rpm*s/rad\n", "  zero: 56.9706 1/s\n")
    text = replaced(SOFT_TISSUE.read_text(), *((line, "") for line in lines))
    near = "{min: 0.95, max: 1.05}"
    text = text.replace("design:\n", f"design:\n  free: {{motion: {{Kp: {near}, Kd: {near}}}}}\n")
    spec = parse_spec(f"{text}goals: {{decay_rate: 1 1/s}}\n")
    design = design_controllers(spec, build_plant(spec))
    gains = gains_of(design)
    for gain in ("Kp", "Kd"):
        moved = round_float32(design.laws["motion"].gains[gain] * Fraction(factor))
        gains["motion"][gain] = exact_decimal(moved)
    if fits:
        assert gains_of(apply_free_gains(spec, design, gains)) == gains
        return
    with pytest.raises(CertificateError, match="gain Kp of motion is outside its bounds"):
        apply_free_gains(spec, design, gains)
