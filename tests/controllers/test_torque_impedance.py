"""The law of a robot that takes torques: its numbers, its operations, and its roundings."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.laws.torque_impedance import TorqueImpedance
from nrs_design.controllers.replica import step
from nrs_design.controllers.step_law import StepFrame, StepLimits, build_law
from nrs_design.errors import DesignError
from nrs_design.loop.program import kinds_of, list_law
from nrs_design.models.drive import CommandInterface

F = Fraction
T = F(1, 1000)
ZERO = F(0)
PLAIN, SHAPED = TorqueImpedance(F(30), F(3)), TorqueImpedance(F(30), F(3), F(1, 2))


def test_a_wanted_inertia_scales_spring_damper_and_force():
    """Of R times the inertia: K/R, D/R, and 1/R - 1 of the force off."""
    assert PLAIN.gains == {"K": 30, "D": 3}
    assert SHAPED.gains == {"K": 30, "D": 3, "R": F(1, 2)}
    assert PLAIN.discretize(T, "exact").numbers == {"Kp": 30, "Kd_over_T": 3000}
    assert SHAPED.discretize(T, "exact").numbers == {"Kp": 60, "Kd_over_T": 6000, "Kf_torque": 1}
    assert TorqueImpedance.create(SHAPED.gains) == SHAPED


@pytest.mark.parametrize("limit", [None, F(10)])
def test_the_program_is_the_formula(limit):
    laws = {"plain": PLAIN.discretize(T, "exact"), "shaped": SHAPED.discretize(T, "exact")}
    frame = StepFrame(
        ZERO, ZERO, limits=StepLimits(command=limit), interface=CommandInterface.TORQUE
    )
    law = build_law(frame, laws)
    assert [value.name for value in law.inputs] == ["angle", "torque", "position"]
    assert [value.name for value in law.states] == ["error_before"]
    angle, torque, position, before = 0.02, 1.5, 0.05, 0.029
    for mode, (Kp, D, Kf) in enumerate([(30, 3000, 0), (60, 6000, 1)]):
        e = position - angle
        wanted = Kp * e + D * (e - before) - Kf * torque
        numbers = (angle, torque, position, before)
        given = {v.name: np.float32([n]) for v, n in zip(law.values, numbers, strict=True)}
        made = step(law, np.uint32([mode]), given)
        assert made.valid.all()
        assert made.states["error_before"] == pytest.approx([e], rel=1e-6)
        top = np.inf if limit is None else float(limit)
        assert made.outputs["command"] == pytest.approx([np.clip(wanted, -top, top)], rel=1e-4)


def test_its_roundings_are_counted():
    """One for the error, two and three for the terms of the PD, and those of the force."""
    kinds = kinds_of([SHAPED.discretize(T, "exact")])
    counts = list_law(0, kinds, CommandInterface.TORQUE).all_counts
    assert counts == {"e": 1, "Kp e": 3, "D (e - e before)": 4, "Kf F": 3}


def test_it_has_no_form_in_continuous_time():
    with pytest.raises(DesignError, match="no form in continuous time") as caught:
        PLAIN.respond([F(1)], [])
    assert caught.value.remedy
