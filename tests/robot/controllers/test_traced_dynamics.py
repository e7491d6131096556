"""The full dynamics from few operations, against the model, for flat robots without symmetry."""

from dataclasses import replace

from nrs_design.robot.controllers.traced_dynamics import is_flat
from nrs_design.robot.models.body import Body
from nrs_design.robot.models.lumped import lumped
from tests.robot.controllers.test_step_laws import THESIS, check_torques
from tests.robot.models.crooked import crooked


def uneven(robot):
    """Legs of other lengths and directions, arms with mass beside their lines, rotors and disks."""
    more = Body(0.05, (0.002, 0.003, 0.0), ((4e-4, 2e-4, 0.0), (2e-4, 5e-4, 0.0), (0.0, 0.0, 3e-4)))
    legs = tuple(
        replace(
            leg,
            azimuth=leg.azimuth + 0.3 + 0.05 * k,
            l0=leg.l0 * (1 + 0.02 * k),
            l1=leg.l1 * (1 - 0.01 * k),
            l3=leg.l3 * (1.02 - 0.015 * k),
            arm=leg.arm.plus(more),
            axis_inertia=1e-3 * (k + 1),
        )
        for k, leg in enumerate(robot.legs)
    )
    return replace(robot, legs=legs)


def test_which_robots_are_flat():
    assert is_flat(lumped(THESIS))
    assert is_flat(lumped(uneven(THESIS)))
    assert not is_flat(lumped(crooked(THESIS)))
    assert not is_flat(THESIS)


def test_torques_are_those_of_the_model():
    """The model is checked against Pinocchio elsewhere."""
    check_torques(uneven(THESIS))
