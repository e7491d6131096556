"""A motor that is known to within ranges, in continuous time: known answers for the thesis's robot.

The verdicts and rates were found by an independent program.
"""

from dataclasses import replace
from fractions import Fraction

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from tests.proof.graphs import shape_of
from tests.search.support import thesis_robot
from tests.support import words_of
from tests.tables import by_rows

SOFT, BOTH, INSERTION = ("41.5", "44.2"), ("2.15", "1.04"), ("2.15",)
ANY_RATE = Limits(optimize_rate=False)


@by_rows("Bt", "tolerance", "load", "rate")
def test_tolerances_that_are_proved_while_contact_is_lost(Bt, tolerance, load, rate):
    system = thesis_robot(SOFT, Bt, "0.01", tolerance, load)
    found = certify(system, limits=Limits(optimize_rate=rate is not None)).evidence
    assert shape_of(found) == "conewise-quadratic"
    assert rate is None or float(found.rate) > 0.98 * rate


def test_a_tolerance_of_27_percent_is_proved_for_opposite_corners_and_false_for_all():
    """Gain and time constant at their ends together do not suffice: the other corners grow."""
    system = thesis_robot(SOFT, BOTH, "0.01", "0.27", contact="kept")
    ends = ("Km-min/tau-min", "Km-max/tau-max")
    few = replace(system, modes=tuple(m for m in system.modes if m.name.endswith(ends)))
    assert len(few.modes) == len(system.modes) / 2
    found = certify(few, Method.LMI, ANY_RATE)
    assert found.verdict is Verdict.PROVED
    fault = replace(found.evidence).find_fault(system)
    assert "V does not decrease" in fault
    # Found by the search for periods, with more digits.
    names = "c1/soft/k-max/Km-min/tau-max", "c1/soft/k-max/Km-max/tau-min"
    period = zip(names, (Fraction(241, 4096), Fraction(181, 8192)), strict=True)
    assert GrowingSequence(tuple(period), 12).find_fault(system) is None


def test_states_and_assumptions():
    system = thesis_robot(SOFT, BOTH, "0.01", "0.02", "1.213")
    assert system.states == ("e [rad]", "omega [rad/s]", "vm [rad/s]", "delta [rad]")
    assert len(system.modes) == 16
    assert len(system.contact.free) == 8
    text = " ".join(words_of(system))
    assert "its gain stays in [0.0004744866, 0.0004938534] rad/s/rpm" in text
    assert "its time constant stays in [0.034398, 0.035802] s, and may change" in text
    assert "against an inertia of 1.213 kg*m^2" in text
    assert system.assumptions[0].id == "motor.joint"
    unloaded = thesis_robot(SOFT, BOTH, "0.01", "0.02")
    assert "does not slow the motor" in " ".join(words_of(unloaded))


def test_a_load_alone_makes_physical_states_and_no_corners():
    system = thesis_robot(SOFT, INSERTION, "0.01", load="1.213")
    assert system.states[0] == "e [rad]"
    assert len(system.modes) == 2
    # In flight there is no force.
    assert all(row[-1] == 0 for row in system.contact.free[0].A.fractions())
    assert system.modes[0].A.fractions()[1][-1] == -Fraction("41.5") / Fraction("1.213")
