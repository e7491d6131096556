"""The program of a processor: its list of operations, and its roundings in single precision."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.verify import verify
from nrs_design.controllers import laws as module
from nrs_design.controllers import step_law
from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.operations import Operation
from nrs_design.controllers.replica import step
from nrs_design.controllers.sensor import DiscreteLowPass
from nrs_design.controllers.step_analysis import UNIT, rounding_share
from nrs_design.controllers.step_law import StepFrame, build_law
from nrs_design.errors import InternalError
from nrs_design.loop.program import kinds_of, list_law, short
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.loop.frames import Frame, frame_of
from tests.support import ROOT

PERIOD = Fraction(1, 500)
TAU, KM = Fraction("0.0351"), Fraction("4.8417e-4")
MOTION = StepFrame(Fraction("117359.43"), Fraction(1_030_000))


def _frame(delay: int, *laws: module.DiscreteLaw) -> Frame:
    return frame_of(PERIOD, MOTION, laws or (_law("1.04"),), delay, TAU)


def _force(Kf: Fraction) -> module.DiscreteLaw:
    return module.DiscreteLaw(module.ProportionalForce, {"Kf": Kf})


POSITION = module.DiscreteLaw(module.PositionControl, {})


def _law(Bt: str) -> module.DiscreteLaw:
    a = np.exp(-float(Bt) * 0.002 / 0.01)
    return module.Admittance.discrete(Fraction(a), Fraction((1 - a) / float(Bt)), PERIOD)


SINGLE = (
    (_law("1.04"),),
    (module.Admittance.discrete(None, Fraction(3, 8), PERIOD), _force(Fraction(1, 50))),
    (module.Admittance.discrete(Fraction(5, 8), Fraction(3, 16), PERIOD, Fraction(3, 2)),),
    (module.Admittance.discrete(Fraction(5, 8), Fraction(3, 16), PERIOD, Fraction(3, 2)), POSITION),
    (_force(Fraction(1, 50)), POSITION),
    (
        module.DiscreteLaw(module.IntegralForce, {"Kf": Fraction(1, 50), "Ki_T": Fraction(1, 900)}),
        POSITION,
    ),
)


def rounded(law: module.DiscreteLaw) -> module.DiscreteLaw:
    return module.DiscreteLaw(law.law, {name: round_float32(n) for name, n in law.numbers.items()})


STREAMED = ((_law("1.04"),), (module.Admittance.discrete(None, Fraction(3, 8), PERIOD),))


@pytest.mark.parametrize("order", [0, 2])
@pytest.mark.parametrize(
    ("laws", "motion"),
    [
        *((laws, MOTION) for laws in SINGLE),
        # A robot that takes velocities.
        *((laws, StepFrame(Fraction(0), Fraction(0))) for laws in STREAMED),
    ],
)
def test_single_precision_never_leaves_the_roundings(laws, motion, order):
    """One step of the list in float32, from random states: no state is off by more than is allowed.

    The rows of the frame say what exact arithmetic makes of the same numbers, and how far rounding
    leads; angles are rounded by shares of the largest one. Controllers change at every step.
    """
    rng, idle, nearest = np.random.default_rng(14), Fraction(15, 16), Fraction(0)
    laws = tuple(map(rounded, laws))
    p, q = Fraction(3, 5), Fraction(2, 5)
    low_pass = DiscreteLowPass(order, round_float32(p), round_float32(q)) if order else None
    step_frame = replace(motion, Kp=round_float32(motion.Kp), low_pass=low_pass)
    frame = frame_of(PERIOD, step_frame, laws, 1, TAU, idle)
    law = build_law(step_frame, {str(i): one for i, one in enumerate(laws)}, idle)
    n, values = len(frame.states), {"Km": KM}
    for _ in range(60):
        mode = int(rng.integers(len(laws)))
        held = {v.name: np.float32(0.1 * rng.normal()) for v in law.values}
        held |= dict.fromkeys(("position", "wanted_torque", "commanded"), np.float32(0))
        made = step(law, np.array([mode], np.uint32), {k: np.array([v]) for k, v in held.items()})
        exact = {name: Fraction(float(value)) for name, value in held.items()}
        x = {text: exact[name] for name, text in frame.stored.items()}
        x |= {"delta [rad]": exact.get("angle", Fraction(0)), "omega [rad/s]": Fraction(0)}
        # What is read is the nearest number to the force.
        x["F 1 before [N*m]"] = exact["torque"] * (1 + Fraction(rng.uniform(-1, 1)) * UNIT)
        if "reference" in exact:
            x["e [rad]"] -= exact["angle"]
        state = [*map(x.get, frame.states), exact.get("velocity_command", Fraction(0))]
        rows = frame.rows(laws[mode], 1, values)[:-1]
        after = [sum(c * v for c, v in zip(row, state, strict=False)) for row in rows]
        angles = exact.keys() & {"angle", "reference", "offset"}
        largest = 2 * max((abs(exact[k]) for k in angles), default=Fraction(0))
        sizes = [0, 0, 0, 0, rounding_share(1) * largest, rounding_share(3) * largest, 0]
        sizes += [abs(size) for size in after[n:]]
        found = {
            frame.stored[name]: Fraction(float(value[0]))
            for name, value in made.states.items()
            if name in frame.stored
        }
        command = Fraction(float(made.outputs["command"][0]))
        speed = frame.states.index("omega [rad/s]")
        found["omega [rad/s]"] = KM * (1 - rows[speed][speed]) * command
        if "reference" in exact:
            found["e [rad]"] -= after[n - 1]
        for name, value in found.items():
            i = frame.states.index(name)
            allowed = sum(abs(c) * s for c, s in zip(rows[i][n:], sizes, strict=True))
            assert abs(value - after[i]) <= allowed, name
            if allowed:
                nearest = max(nearest, abs(value - after[i]) / allowed)
    assert nearest > Fraction(1, 5)


def test_the_share_of_many_roundings():
    """Not below n u / (1 - n u), of which no product of n factors 1 + u has more."""
    for n in range(1, 16):
        assert (1 + UNIT) ** n - 1 <= n * UNIT / (1 - n * UNIT) <= rounding_share(n)
        assert rounding_share(n) < n * UNIT * (1 + Fraction(1, 10**6))
    for n in (0, 16):
        with pytest.raises(ValueError, match="not counted"):
            rounding_share(n)


def test_what_rounds_an_error_again_is_counted():
    """The command takes the rounded error, so a rounded reference changes what u rounds, too."""
    frame = _frame(1, _force(Fraction(1, 2)))
    assert [*frame.counts] == ["e", "Kp e", "D (e - e before)", "Kp F"]
    assert [*frame.roundings] == [*frame.counts, "u of Kp F"]
    shares = frame.roundings
    assert shares["u of Kp F"] >= shares["Kp F"] * rounding_share(3)


SPEC = ROOT / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"
CERTIFICATE = ROOT / "reports/soft-tissue-sampled.cert.json"
MOVING = module.Admittance.discrete(Fraction(1), Fraction(0), Fraction(1))
FORCE = module.ProportionalForce(Fraction(1)).discretize(Fraction(1), "exact")
HOLDING = module.PositionControl().discretize(Fraction(1), "exact")


@pytest.fixture
def alter(monkeypatch):
    """Put other operations in the place of those of the motion controller, or of an admittance."""
    given, parts = step_law.motion_operations, module.Admittance.parts

    def put(where, change):
        if where == "motion":
            monkeypatch.setattr(
                step_law, "motion_operations", lambda *a, **b: change([*given(*a, **b)])
            )
        else:
            monkeypatch.setattr(module.Admittance, "parts", lambda *a, **b: altered(parts(*a, **b)))
        list_law.cache_clear()

        def altered(found):
            return tuple(
                replace(part, state_operations=tuple(change([*part.state_operations])))
                for part in found
            )

    yield put
    monkeypatch.undo()
    list_law.cache_clear()


def one(name, **other):
    """Change one operation."""
    return lambda found: [replace(o, **other) if o.name == name else o for o in found]


def velocity_first(found):
    """Let the reference move on with the velocity of after the sample."""
    return [replace(o, second="next_velocity") if o.name == "relative" else o for o in found]


ALTERED = {
    "as it is": ("motion", lambda found: found),
    "a sign": ("motion", one("command", kind="subtract")),
    "a coefficient": ("motion", one("proportional", first="Kd_over_T")),
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
    alter("motion", one("derivative", second="error"))
    with pytest.raises(InternalError, match="second order of D e is not bounded"):
        list_law(0, kinds_of([MOVING]))


def test_terms_are_counted_whatever_the_numbers():
    """With coefficients zero and one, too, of which products are exact."""
    counts = list_law(0, kinds_of([FORCE, MOVING, HOLDING])).counts
    assert [*counts] == ["impedance", "position", "force"]
    assert counts["force"]["error"] == {"e": 1, "Kp F": 5}
    assert counts["position"]["error"] == {"e": 1}
    assert counts["position"]["next_velocity"] == {"d vm": 1}
    assert counts["impedance"]["next_velocity"] == {"a vm": 2, "b F": 3}
    assert counts["impedance"]["next_offset"] == {"T (v - vm)": 2}


def test_what_the_loop_has_not_is_no_state_of_it():
    sprung = module.Admittance.discrete(Fraction(1), Fraction(1), Fraction(1), Fraction(1))
    listed = list_law(0, kinds_of([sprung]))
    assert {*listed.law.following} - {*listed.following} == {"commanded"}
    assert "T v" not in listed.all_counts


CONTROLLER = StepFrame(Fraction(117359), Fraction(1_030_000))


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
        law = module.Admittance.discrete(sign * a, Fraction(1), Fraction(1, 500))
        frame = frame_of(Fraction(1, 500), CONTROLLER, (law,), 0, Fraction("0.0351"))
        row = len(frame.states) + [*frame.roundings].index("a vm")
        sizes.append(frame.rows(law, 0, values)[row][frame.states.index("vm [rad/s]")])
    assert sizes[0] == -sizes[1]
    assert sizes[0] >= frame.roundings["a vm"] * a
