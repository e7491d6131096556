"""The best admittance under goals: a global optimum, or an error that names the goal."""

import math
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from nrs_design.design.constrained import best_rounding, meets, optimize_with_goals
from nrs_design.design.goals import Requirement, corners_of
from nrs_design.design.impedance_optimum import (
    ImpedanceLoop,
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
    stabilizes,
)
from nrs_design.design.measures import (
    DELAY_MARGIN,
    DISK_MARGIN,
    GAIN_MARGIN,
    IMPEDANCE_ERROR,
    PHASE_MARGIN,
    SENSITIVITY_PEAK,
)
from nrs_design.design.transfer import frequency_response
from nrs_design.errors import DesignError
from nrs_design.models.contact import Elastic, KelvinVoigt
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from tests.design.classical import displayed_impedance_at, loop_margins
from tests.design.motion_loops import EXACT, PLACE, axis_with

# Thesis 6.2 and 6.3.1: half the impedance of 0.3 N m over 8 deg/s; 2 Hz; k_soft and its range.
HALF = 0.15 / math.radians(8)
BANDWIDTH = 4 * math.pi
SOFT = Interval(Fraction("43.0356"), Fraction("41.5043"), Fraction("44.2466"))
STIFFNESSES = [float(k) for k in (SOFT.nominal, SOFT.low, SOFT.high)]

GOALS = {
    "peak": ((SENSITIVITY_PEAK, 2.0),),
    "phase": ((PHASE_MARGIN, math.radians(40)),),
    "gain": ((GAIN_MARGIN, 3.0),),
    "delay": ((DELAY_MARGIN, 0.03),),
    "disk": ((DISK_MARGIN, 0.6),),
    "several": ((SENSITIVITY_PEAK, 2.5), (DELAY_MARGIN, 0.02), (IMPEDANCE_ERROR, 1.5)),
}


def problem(least=0.01, desired=HALF, **bounds):
    return ImpedanceProblem(
        loop=ImpedanceLoop(EXACT, Elastic(float(SOFT.nominal))),
        desired=desired,
        bandwidth=BANDWIDTH,
        mass_bounds=bounds.get("mass", (least, 1.0)),
        damping_bounds=bounds.get("damping", (0.1, 20.0)),
    )


def requirement(goals, desired=HALF):
    environment = Environment("soft", KelvinVoigt, (SOFT, Interval.point(Fraction(0))))
    corners = corners_of((environment,), "soft", (PLACE,))
    return Requirement(axis_with(EXACT), corners, goals, desired, BANDWIDTH)


def on_grid(goals, Mt, Bt, slack):
    """Oracle: which admittances meet goals by a share of slack, by a frequency grid."""
    omega = np.geomspace(0.5, 500, 1200)
    s, G = 1j * omega, frequency_response(EXACT, omega)
    allowed = np.ones(len(Mt), dtype=bool)
    for k in STIFFNESSES:
        loop = ImpedanceLoop(EXACT, Elastic(k))
        allowed &= stabilizes(loop, Mt, Bt)
        L = G * (k / s) / (Mt[:, None] * s + Bt[:, None])
        S = 1 / (1 + L)
        crossing = np.diff(np.sign(np.abs(L) - 1), axis=1) != 0
        phase = np.where(crossing, np.angle(-L)[:, :-1], np.inf)
        turn = (np.diff(np.sign(L.imag), axis=1) != 0) & (L.real[:, :-1] < 0)
        band = np.linspace(0, BANDWIDTH, 200)
        for measure, goal in goals:
            if measure is SENSITIVITY_PEAK:
                allowed &= np.abs(S).max(axis=1) <= goal * (1 - slack)
            elif measure is DISK_MARGIN:
                allowed &= 1 / np.abs(S - 0.5).max(axis=1) >= goal * (1 + slack)
            elif measure is PHASE_MARGIN:
                allowed &= np.abs(phase).min(axis=1) >= goal * (1 + slack)
            elif measure is DELAY_MARGIN:
                allowed &= (phase / omega[:-1]).min(axis=1) >= goal * (1 + slack)
            elif measure is GAIN_MARGIN:
                gains = np.where(turn, 1 / np.abs(L[:, :-1]), np.inf)
                allowed &= gains.min(axis=1) >= goal * (1 + slack)
            else:
                for i in np.flatnonzero(allowed):
                    Z = np.abs(displayed_impedance_at(loop, Mt[i], Bt[i], band))
                    error = max(Z.max() / HALF, HALF / Z.min())
                    allowed[i] = error <= goal * (1 - slack)
    return allowed


@cache
def optimum_of(name):
    return optimize_with_goals(problem(), requirement(GOALS[name]))


EACH = [pytest.param(name, marks=[] if name == "several" else pytest.mark.slow) for name in GOALS]


@pytest.mark.slow
@pytest.mark.parametrize("name", EACH)
def test_no_point_of_a_dense_scan_is_better(name):
    goals = GOALS[name]
    optimum = optimum_of(name)
    assert optimum.cost > optimize_impedance(problem()).cost
    assert optimum.cost == pytest.approx(float(impedance_cost(problem(), optimum.Mt, optimum.Bt)))
    Mt, Bt = np.meshgrid(
        np.unique([*np.geomspace(0.01, 1, 16), *(optimum.Mt * np.linspace(1, 1.2, 4))]),
        np.unique([*np.geomspace(0.1, 20, 50), *(optimum.Bt * np.linspace(0.9, 1.1, 15))]),
    )
    Mt, Bt = Mt.ravel(), Bt.ravel()
    allowed = on_grid(goals, Mt, Bt, slack=5e-3)
    assert 0 < allowed.sum() < allowed.size
    assert impedance_cost(problem(), Mt[allowed], Bt[allowed]).min() >= optimum.cost - 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", EACH)
def test_the_optimum_meets_its_goals_in_every_corner_by_python_control(name):
    optimum = optimum_of(name)
    for k in STIFFNESSES:
        loop = ImpedanceLoop(EXACT, Elastic(k))
        margins = loop_margins(loop, optimum.Mt, optimum.Bt)
        reached = {
            SENSITIVITY_PEAK: margins.sensitivity_peak,
            GAIN_MARGIN: margins.gain_margin,
            PHASE_MARGIN: margins.phase_margin,
            DELAY_MARGIN: margins.delay_margin,
            DISK_MARGIN: margins.disk_margin,
        }
        for measure, goal in GOALS[name]:
            if measure in reached:
                assert measure.violation(reached[measure], goal) <= 1e-6


def test_goals_that_are_met_anyway_change_nothing():
    """The published optimum stays, to the last bit."""
    loose = requirement(((SENSITIVITY_PEAK, 4.0), (GAIN_MARGIN, 1.5)))
    assert optimize_with_goals(problem(), loose) == optimize_impedance(problem())


def test_goals_may_take_the_mass_off_its_bound_but_not_beyond():
    optimum = optimize_with_goals(problem(least=0.0), requirement(GOALS["peak"]))
    assert 0 <= optimum.Mt <= 1
    assert meets(requirement(GOALS["peak"]), optimum.Mt, optimum.Bt)


@pytest.mark.slow
def test_a_goal_out_of_reach_is_named_with_the_best_value():
    tight = requirement(((GAIN_MARGIN, 1.2), (SENSITIVITY_PEAK, 1.01)))
    with pytest.raises(DesignError, match="the goal max_sensitivity_peak, at most") as caught:
        optimize_with_goals(problem(), tight)
    message = caught.value.message
    assert "cannot be met with Mt in [0.01, 1] kg m^2 and Bt in [0.1, 20] N m s/rad" in message
    best = float(message.split("the best is ")[1].split(" ")[0])
    # As good as the best point of a scan, and rounded to the side that can be reached.
    Mt, Bt = np.meshgrid(np.geomspace(0.01, 1, 60), np.geomspace(0.1, 20, 300))
    scanned = requirement(()).values(SENSITIVITY_PEAK, Mt.ravel(), Bt.ravel())[0].min()
    assert best == pytest.approx(scanned, rel=2e-3)
    reachable = requirement(((SENSITIVITY_PEAK, best),))
    assert meets(reachable, *_gains(optimize_with_goals(problem(), reachable)))


@pytest.mark.slow
def test_goals_that_exclude_each_other_are_said_to():
    both = requirement(((SENSITIVITY_PEAK, 1.3), (IMPEDANCE_ERROR, 1.2)))
    with pytest.raises(DesignError, match="cannot be met together") as caught:
        optimize_with_goals(problem(), both)
    assert "max_sensitivity_peak at most 1.3" in caught.value.message
    assert "max_impedance_error at most 1.2" in caught.value.message
    assert "widen the bounds of Mt, or" in caught.value.remedy


def test_bounds_without_a_stable_point_are_said_to_be_so():
    with pytest.raises(DesignError, match="keeps the loop stable"):
        optimize_with_goals(
            problem(mass=(0.5, 1.0), damping=(0.1, 0.2)), requirement(GOALS["peak"])
        )


def test_rounding_never_loses_a_goal():
    goals = requirement(GOALS["peak"])
    optimum = optimum_of("peak")
    Bt = optimum.Bt
    pair = best_rounding(problem(), goals, ([optimum.Mt], [Bt - 0.01, Bt, Bt + 0.01]))
    assert pair == (optimum.Mt, Bt)
    assert best_rounding(problem(), goals, ([optimum.Mt], [Bt - 0.01])) is None


def _gains(optimum):
    return optimum.Mt, optimum.Bt
