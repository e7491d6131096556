"""How an estimator decides, and when it cannot."""

from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import SpecError
from nrs_design.spec import load_spec, parse_spec
from nrs_design.spec.environment_estimator import decide
from tests.support import ROOT

PATH = ROOT / "docs/examples/unknown-environment.nrs.yaml"


def decision(spec):
    return decide(spec.mode_logic, spec.controllers, spec.environments)


def test_by_hand():
    """0.5 mN m and 2 ms at 15 N m/s make 30.5 mN m; three segments at 6 deg/s, and the age."""
    found = decision(load_spec(PATH))
    e = 0.001 * 3.14159265358979 / 180 / 2
    gap = 104.7 - 43.0356
    travel = 4 * (0.0305 + e * 104.7) / gap
    assert float(found.travel) == pytest.approx(travel, rel=1e-9)
    assert found.limit == (Fraction("43.0356") + Fraction("104.7")) / 2
    segment = (travel + 2 * e) / (6 * 3.14159265358979 / 180) + 0.002
    assert float(found.delay) == pytest.approx(0.002 + 3 * segment, rel=1e-3)
    assert float(found.delay) >= 0.002 + 3 * segment
    assert found.stay == 1 - found.delay


STEP, NOISE, AGE, PERIOD, SLOWEST = 1.7453292519943296e-05, 5e-4, 2e-3, 2e-3, 0.10471975512
STIFFNESS = {False: 43.0356, True: 104.7}


def estimate(found, stiffer, samples):
    """Take the steps of docs/design/mode-logic.md; yield what is taken to be touched."""
    last, (begin, angle, torque) = stiffer, samples[0]
    for t, theta, F in samples:
        if abs(theta - angle) >= found.travel and t - begin >= AGE:
            spoken = (F - torque) / (theta - angle) >= found.limit
            stiffer, last = spoken if spoken == last else stiffer, spoken
            begin, angle, torque = t, theta, F
        yield stiffer


def measure(first, change, speed, errors):
    """Yield time, angle and torque, with errors, through one change of the environment."""

    def torque(t):
        # Both springs carry the same force where the environment changes.
        return 0.1 + STIFFNESS[first if t < change else not first] * speed * (t - change)

    for k, (e, n, age) in enumerate(errors):
        t = k * PERIOD
        yield t, speed * t + e * STEP / 2, torque(t - age * AGE) + n * NOISE


error = st.tuples(st.sampled_from([-1, 1]), st.sampled_from([-1, 1]), st.sampled_from([0, 0.5, 1]))


@given(
    st.booleans(),
    st.floats(0.1, 0.15),
    st.floats(1, 1.33),
    st.lists(error, min_size=120, max_size=120),
    st.sampled_from([-1, 1]),
)
def test_decided_in_time_and_once(first, change, faster, errors, direction):
    """From 6 to 8 deg/s, with errors at the ends of what is declared."""
    found = decision(load_spec(PATH))
    samples = list(measure(first, change, direction * SLOWEST * faster, errors))
    seen = [(t, s) for (t, *_), s in zip(samples, estimate(found, first, samples), strict=True)]
    assert all(stiffer == first for t, stiffer in seen if t < change)
    assert all(stiffer != first for t, stiffer in seen if t >= change + float(found.delay))
    assert sum(a[1] != b[1] for a, b in pairwise(seen)) == 1


def test_wrong_modes_are_left_and_right_ones_last():
    spec = load_spec(PATH)
    found = decision(spec)
    for right in ("agile/tissue", "careful/tool"):
        assert spec.switching.stay(right)[0].value == found.stay
        assert spec.switching.stay(right)[1] is None
    for wrong in ("agile/tool", "careful/tissue"):
        assert spec.switching.stay(wrong)[0] is None
        assert spec.switching.stay(wrong)[1].value == found.delay
    assert ("agile/tissue", "careful/tool") not in spec.switching.transitions


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("104.7 N*m/rad", "43.0356 N*m/rad", "ranges overlap"),
        ("shortest_contact: 1 s", "shortest_contact: 50 ms", "may take 0.0.* s, but"),
        ("largest_rate: 15", "largest_rate: 10", "both cannot hold"),
        ("contacts: [tissue, tool]", "contacts: [tool, tissue, other]", "no environment 'other'"),
        (
            "environment: tool\n    contacts: [tissue, tool]",
            "environment: tool",
            "two environments",
        ),
        ("model: elastic", "model: kelvin-voigt\n    damping: 1 N*m*s/rad", "tells springs apart"),
        ("slowest_speed: 6 deg/s", "slowest_speed: 0 deg/s", "must be positive"),
        (
            "switching: mode-logic",
            "switching: {longest_dwell_time: {agile/tool: 1 ms}}",
            "leaves agile/tool by",
        ),
        ("switching: mode-logic", "switching: {dwell_time: {agile/tissue: 2 s}}", "rules say 2 s"),
        ("switching: mode-logic", "switching: {transitions: [[agile, careful]]}", "not about what"),
        ("switching: mode-logic", "switching: {dwell_time: {agile/air: 2 s}}", "no controller"),
        (
            "switching: mode-logic",
            "sampling: {period: 2 ms, delay: 1}\nswitching: mode-logic",
            "beside a sampled loop",
        ),
        (
            "stiffness: 43.0356 N*m/rad",
            "stiffness: {nominal: 43 N*m/rad, range: [42 N*m/rad, 44 N*m/rad]}",
            "beside the range of environment 'tissue'",
        ),
    ],
)
def test_what_is_refused(old, new, message):
    text = PATH.read_text()
    assert old in text
    with pytest.raises(SpecError, match=message):
        parse_spec(text.replace(old, new))


def test_ranges_narrow_the_gap_where_switching_is_arbitrary():
    text = PATH.read_text().replace("switching: mode-logic", "switching: arbitrary")
    wide = text.replace(
        "104.7 N*m/rad", "{nominal: 104.7 N*m/rad, range: [90 N*m/rad, 105 N*m/rad]}"
    )
    exact, ranged = (decision(parse_spec(written)) for written in (text, wide))
    assert ranged.limit == (Fraction("43.0356") + 90) / 2
    assert ranged.delay > exact.delay
