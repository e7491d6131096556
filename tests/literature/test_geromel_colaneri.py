"""J. C. Geromel and P. Colaneri, "Stability and stabilization of continuous-time switched linear
systems", SIAM Journal on Control and Optimization 45(5), 2006.

One quadratic function per mode shows stability for dwell times above 2.75084 s; the pair is
unstable with dwell times up to 2.70775 s, hence under arbitrary switching.
"""

from dataclasses import replace

import pytest

from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Limits, certify
from nrs_design.spec import parse_exact
from tests.proof.graphs import shape_of
from tests.support import holds

from .known import known


def certify_with_dwell_time(seconds: str):
    system = known("geromel-colaneri").system
    system = replace(system, switching=Switching(dwell_time=parse_exact(seconds)))
    # Beyond this degree, a polynomial only takes time: none of these verdicts is by one.
    found = certify(system, limits=Limits(max_degree=4))
    assert all(holds(system, statement) for statement in found.statements)
    return found


@pytest.mark.parametrize("seconds", ["2.751", "2.76", "5"])
def test_stable_with_a_long_dwell_time(seconds):
    found = certify_with_dwell_time(seconds)
    assert (found.verdict, found.common_quadratic) == ("proved", "impossible")
    assert shape_of(found.evidence) == "mode-quadratic"


@pytest.mark.parametrize("seconds", ["1", "2.7", "2.707"])
def test_unstable_with_a_short_dwell_time(seconds):
    found = certify_with_dwell_time(seconds)
    assert (found.verdict, found.common_quadratic) == ("refuted", "impossible")
    assert all(dwell >= parse_exact(seconds) for _, dwell in found.evidence.steps)


@pytest.mark.parametrize("seconds", ["2.72", "2.74"])
def test_nothing_wrong_between_the_two_bounds(seconds):
    # Beyond 2.70775 s no signal of one dwell time per mode is known to grow.
    assert certify_with_dwell_time(seconds).verdict != "refuted"
