from nrs_design.controllers.laws import Admittance, PositionControl, ProportionalForce
from nrs_design.pipeline import run_design
from nrs_design.spec import read_spec
from tests.support import FORCE_LIMIT, SOFT_TISSUE


def test_order_and_contacts_of_the_spec():
    design = run_design(read_spec(SOFT_TISSUE)).design
    assert [(c.name, c.environment, c.contacts) for c in design.controllers] == [
        ("insertion", "soft", ("soft",)),
        ("withdrawal", "soft", ("soft",)),
    ]
    assert all(isinstance(c.law, Admittance) for c in design.controllers)


def test_position_control_touches_nothing():
    position, force = run_design(read_spec(FORCE_LIMIT)).design.controllers
    assert (position.law, position.environment, position.contacts) == (PositionControl(), None, ())
    assert isinstance(force.law, ProportionalForce)
