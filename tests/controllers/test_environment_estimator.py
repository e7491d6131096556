"""The estimator as it runs: it decides in time, once, and not before there is a change."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.environment_estimator import EnvironmentEstimator
from nrs_design.spec import load_spec
from nrs_design.spec.environment_estimator import decide
from tests.support import ROOT

SPEC = load_spec(ROOT / "docs/examples/unknown-environment.nrs.yaml")
DECISION = decide(SPEC.mode_logic, SPEC.controllers, SPEC.environments)
ESTIMATOR = EnvironmentEstimator.of(SPEC.mode_logic, DECISION)
STEP, NOISE, AGE, PERIOD, SLOWEST = 1.7453292519943296e-05, 5e-4, 2e-3, 2e-3, 0.10471975512
STIFFNESS = {False: 43.0356, True: 104.7}


def decisions(first, change, speed, errors, direction):
    """Run through one change of the environment; yield time and what the estimator takes it for."""

    def torque(t):
        at = direction * speed * (t - change)
        # Both springs carry the same force where the environment changes.
        return 0.1 + STIFFNESS[first if t < change else not first] * at

    state = ESTIMATOR.start(stiffer=first)
    for k, (e, n, age) in enumerate(errors):
        t = k * PERIOD
        angle = direction * speed * t + e * STEP / 2
        state = ESTIMATOR.step(state, PERIOD, angle, torque(t - age * AGE) + n * NOISE)
        yield t, state.stiffer


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
    speed = SLOWEST * faster
    seen = list(decisions(first, change, speed, errors, direction))
    assert all(stiffer == first for t, stiffer in seen if t < change)
    late = change + float(DECISION.delay)
    assert all(stiffer != first for t, stiffer in seen if t >= late)
    assert sum(a[1] != b[1] for a, b in pairwise(seen)) == 1
