"""A certificate of the sampled loop is about the list of operations, and changes with it."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.verify import verify
from nrs_design.controllers import step_law
from nrs_design.controllers.laws import Admittance, PositionControl, ProportionalForce
from nrs_design.controllers.operations import Operation
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import InternalError
from nrs_design.loop.program import kinds_of, list_law, short
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.loop.frames import frame_of
from tests.support import ROOT

SPEC = ROOT / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"
CERTIFICATE = ROOT / "reports/soft-tissue-sampled.cert.json"
MOVING = Admittance.discrete(Fraction(1), Fraction(0), Fraction(1))
FORCE = ProportionalForce(Fraction(1)).discretize(Fraction(1), "exact")
POSITION = PositionControl().discretize(Fraction(1), "exact")


@pytest.fixture
def alter(monkeypatch):
    """Put other operations in the place of those of the motion controller, or of an admittance."""
    given, parts = step_law.motion_operations, Admittance.parts

    def put(where, change):
        if where == "motion":
            monkeypatch.setattr(
                step_law, "motion_operations", lambda *a, **b: change([*given(*a, **b)])
            )
        else:
            monkeypatch.setattr(Admittance, "parts", lambda *a, **b: altered(parts(*a, **b)))
        list_law.cache_clear()

        def altered(found):
            return tuple(replace(part, after=tuple(change([*part.after]))) for part in found)

    yield put
    monkeypatch.undo()
    list_law.cache_clear()


def one(name, **other):
    """Change one operation."""
    return lambda found: [replace(o, **other) if o.name == name else o for o in found]


def velocity_first(found):
    """Let the reference move on with the velocity of after the sample."""
    return [replace(o, right="next_velocity") if o.name == "relative" else o for o in found]


ALTERED = {
    "as it is": ("motion", lambda found: found),
    "a sign": ("motion", one("command", kind="subtract")),
    "a coefficient": ("motion", one("proportional", left="Kd_over_T")),
    "an order": ("admittance", velocity_first),
    "a rounding": ("admittance", one("next_velocity", rounding="own", symbol="w")),
}


@pytest.mark.parametrize("what", ALTERED)
def test_a_certificate_is_rejected_where_the_law_was_altered(alter, what):
    """The loop is assembled from the list, so that of another law is another loop."""
    alter(*ALTERED[what])
    loaded = read_spec(SPEC)
    try:
        # Gains are chosen with which that loop is stable, so the design assembles it, too.
        designed = run_design(loaded)
        fault = verify(CERTIFICATE, loaded, plant=designed.plant).fault
    except InternalError as error:
        fault = str(error)
    assert (fault is None) == (what == "as it is")


def test_a_rounded_number_taken_somewhere_new_is_refused(alter):
    """What that adds to the roundings there would be left out of the bounds."""
    again = Operation("again", "multiply", "Kp", "error")
    alter("motion", lambda found: [*found, again])
    list_law(0, kinds_of([MOVING]))
    # Not used any further, it is nothing.
    alter("motion", one("derivative", right="error"))
    with pytest.raises(InternalError, match="second order of D e is not bounded"):
        list_law(0, kinds_of([MOVING]))


def test_terms_are_counted_whatever_the_numbers():
    """With coefficients zero and one, too, of which products are exact."""
    counts = list_law(0, kinds_of([FORCE, MOVING, POSITION])).counts
    assert [*counts] == ["impedance", "position", "force"]
    assert counts["force"]["error"] == {"e": 1, "Kp F": 5}
    assert counts["position"]["error"] == {"e": 1}
    assert counts["position"]["next_velocity"] == {"d vm": 1}
    assert counts["impedance"]["next_velocity"] == {"a vm": 2, "b F": 3}
    assert counts["impedance"]["next_offset"] == {"T (v - vm)": 2}


def test_what_the_loop_has_not_is_no_state_of_it():
    sprung = Admittance.discrete(Fraction(1), Fraction(1), Fraction(1), Fraction(1))
    listed = list_law(0, kinds_of([sprung]))
    assert {*listed.law.following} - {*listed.following} == {"commanded"}
    assert "T v" not in listed.all_counts


MOTION = StepFrame(Fraction(117359), Fraction(1_030_000))


@given(st.fractions(max_denominator=10**6).filter(bool))
def test_a_short_number_is_not_smaller(size):
    """Of either sign: a sign says nothing of how large a rounding is."""
    found = short(size)
    assert abs(size) <= abs(found) <= abs(size) * (1 + Fraction(1, 64))
    assert (found > 0) == (size > 0)
    assert abs(found.numerator).bit_length() <= 9 or found.denominator == 1


def test_nothing_stays_nothing():
    assert short(Fraction(0)) == 0


def test_a_velocity_that_changes_its_sign_is_rounded_as_much():
    """Euler's method gives a negative a where Bt T > Mt."""
    values = {"Km": Fraction(1, 2000)}
    a, sizes = Fraction(3, 7), []
    for sign in (1, -1):
        law = Admittance.discrete(sign * a, Fraction(1), Fraction(1, 500))
        frame = frame_of(Fraction(1, 500), MOTION, (law,), 0, Fraction("0.0351"))
        row = len(frame.states) + [*frame.roundings].index("a vm")
        sizes.append(frame.rows(law, 0, values)[row][frame.states.index("vm [rad/s]")])
    assert sizes[0] == -sizes[1]
    assert sizes[0] >= frame.roundings["a vm"] * a
