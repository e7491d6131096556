"""The search for what a safety layer keeps: how near it comes, and why it finds nothing."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.search.safety_layer import search_safety
from nrs_design.simulation.governed import hardest_run
from tests.proof.systems import governed


def found(system):
    search = search_safety(system)
    try:
        return next(search).evidence
    except StopIteration as end:
        return end.value


def of(**changed):
    system = governed()
    return replace(system, safety=replace(system.safety, **changed))


def test_for_one_motor_the_speed_is_the_largest_that_there_is():
    """The hardest steps of the reference reach it but for what rounding adds."""
    system = of(
        gain=(Fraction(1),) * 2,
        time_constant=(Fraction(1, 100),) * 2,
        **dict.fromkeys(("encoder", "sensor", "friction"), Fraction(0)),
    )
    evidence = found(system)
    run = hardest_run(system.safety, system.sample_time)
    fastest = np.abs(run.state[:, 2]).max()
    assert 0.999 < fastest / float(evidence.limits.velocity) <= 1
    assert set(run.mode.tolist()) <= {0, 1}
    assert len(run.time) == len(run.state) == len(run.mode) + 1


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"gain": (Fraction(1, 10), Fraction(4))}, "too wide"),
        ({"Kp": Fraction(300), "D": Fraction(0)}, "not stable"),
        ({"Kp": Fraction(1, 1000), "D": Fraction(0)}, "too slow"),
    ],
)
def test_where_nothing_is_found_it_says_why(changed, words):
    assert words in found(of(**changed))


def test_without_a_layer_there_is_nothing_to_search():
    assert found(replace(governed(), safety=None)) == "there is no safety layer"
