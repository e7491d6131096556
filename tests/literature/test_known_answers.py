"""Every system with a known answer, certified without being told anything about it.

The table beside this file has the sources of what is published.
"""

from fractions import Fraction
from itertools import pairwise

import pytest

from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from tests.proof.graphs import shape_of
from tests.proof.rows import cases, system_in
from tests.support import holds

from .known import names, settle


@pytest.mark.parametrize("name", names("continuous", "discrete"))
def test_known_answer(name):
    settle(name)


@pytest.mark.parametrize(
    "coordinates", ["deflection", pytest.param("force", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("name", names("robot"))
def test_known_answer_of_the_robot(name, coordinates):
    settle(name, coordinates=coordinates)


@pytest.mark.parametrize("case", cases(__file__))
def test_published_answer(case):
    system = system_in(case)
    limits = Limits(max_degree=case["max_degree"]) if "max_degree" in case else Limits()
    found = certify(system, Method(case.get("method", "auto")), limits)
    for item in found.statements:
        assert item.find_fault(system) is None
        # The oracle knows no memory under rules of switching.
        assert str(shape_of(item)).startswith("memory") or holds(system, item)
    for asked in ("verdict", "common_quadratic"):
        assert case.get(asked) in (None, getattr(found, asked))
    assert found.verdict != case.get("never")
    evidence = found.evidence
    if "shape" in case:
        assert shape_of(evidence) == case["shape"]
    if "degree" in case:
        assert 2 * evidence.degree == case["degree"]
    if "degrees" in case:
        assert [part.degree for _, part in evidence.parts if part.degree > 1] == case["degrees"]
    if "modes" in case:
        assert {name for name, _ in evidence.steps} == {*case["modes"]}
    if "rate" in case:
        low, high = map(Fraction, case["rate"])
        assert low <= evidence.proved_rate(system) <= high


def test_the_golden_ratio_is_reached_by_alternating():
    steps = settle("golden-0.6181").evidence.steps
    assert [dwell for _, dwell in steps] == [1] * len(steps)
    assert all(a != b for (a, _), (b, _) in pairwise(steps))
