"""The ladder: its order, and that nothing is found whatever the searches say."""

import re
from dataclasses import replace

import pytest

from nrs_design.errors import DesignError
from nrs_design.proof.evidence import Shows
from nrs_design.proof.switching import Switching
from nrs_design.search.certification import Limits
from nrs_design.search.certify import Verdict, certify
from nrs_design.search.ladder import LADDER, applicable_methods, steps
from nrs_design.search.method import Method
from nrs_design.search.unstable_mode import examine_every_mode
from nrs_design.search.work import Allowance
from tests.proof.systems import (
    ando_shih,
    branicky,
    dayawansa_martin,
    family,
    geromel_colaneri,
    lossy_network,
    shears,
)
from tests.search.support import outcome

PAIR = (("m0", "m1"),)


def test_what_does_not_pass_the_whole_check_is_no_evidence():
    """Which of two modes of one name is meant, a certificate could not say."""
    system = family([[0, 1], [-1, 0]], [[-1, 0], [0, -1]])
    twins = replace(system, modes=tuple(replace(mode, name="twin") for mode in system.modes))
    found, words = outcome(examine_every_mode, twins)
    assert found is None
    assert words == "a candidate was found, but two modes of the system have the same name"
    assert certify(twins, limits=Limits(max_degree=4)).verdict is Verdict.INCONCLUSIVE


def names(system, method=Method.AUTO, *, limits=None, allowance=None, no_quadratic=False):
    """The steps in order, none of which is made."""
    limits, allowance = limits or Limits(), allowance or Allowance()
    known = frozenset({Shows.NO_COMMON_QUADRATIC} if no_quadratic else ())
    found = steps(system, method, limits, allowance, lambda: known)
    return [name for name, _ in found]


def test_the_order_is_cheapest_first_and_higher_degrees_come_last():
    assert names(dayawansa_martin(6), limits=Limits(max_degree=10)) == [
        "suspicious modes",
        "lmi",
        "obstruction",
        "gradient",
        "every mode",
        "mixture",
        "polynomial of degree 4",
        "polynomial of degree 6",
        "period",
        "polynomial of degree 8",
        "polynomial of degree 10",
        "polynomial of degree 12",
    ]


def test_degrees_of_two_kinds_rise_together():
    quick = replace(lossy_network(), switching=Switching(dwell_time=2))
    found = names(quick, limits=Limits(max_degree=8))
    found = [name for name in found if "memory" not in name and "norms" not in name]
    start = found.index("polynomial of degree 4")
    assert found[start:] == [
        "polynomial of degree 4",
        "polynomial of degree 6",
        "mode polynomial of degree 4",
        "mode polynomial of degree 6",
        "period",
        "polynomial of degree 8",
        "mode polynomial of degree 8",
        "polynomial of degree 10",
        "mode polynomial of degree 10",
    ]


def test_memories_grow_longer_before_degrees_rise():
    found = names(lossy_network(), limits=Limits(max_degree=2))
    start = found.index("quadratic with a memory of 2 steps")
    assert found[start + 1] == "quadratic with a memory of 3 steps"
    words = found.index("words in the norms of forms")
    assert start < words < found.index("period")
    assert not any(name.startswith("quartic") for name in found)
    higher = names(lossy_network(), limits=Limits(max_degree=4))
    assert words < higher.index("quartic with a memory of 1 step")


def test_nothing_remembers_in_continuous_time():
    assert not any("memory" in name for name in names(dayawansa_martin(6)))


def test_without_a_common_quadratic_none_is_looked_for_again():
    left = names(dayawansa_martin(6), limits=Limits(max_degree=4), no_quadratic=True)
    assert "gradient" not in left
    assert "polynomial of degree 4" in left


@pytest.mark.parametrize(
    ("system", "others"),
    [
        (family([[-1]], [[-2]]), ["one state", "obstruction", "gradient"]),
        (geromel_colaneri(3), ["lmi", "mode quadratic", "gradient"]),
        (ando_shih("0.7"), ["lmi", "mode quadratic", "gradient"]),
        (
            shears(Switching(fixed_ends=(("m0", "m1"),))),
            ["constant values", "constants quadratic", "switching at constant values"],
        ),
    ],
    ids=["one state", "dwell", "discrete", "constant"],
)
def test_what_the_kind_of_switching_and_time_asks_for(system, others):
    found = names(system, limits=Limits(max_degree=2))
    assert set(others) <= set(found)
    assert ("lmi" in found) is (system.order > 1)
    assert ("mixture" in found) is (system.switching.is_arbitrary and system.time == "continuous")


@pytest.mark.parametrize("method", [m for m in Method if m is not Method.AUTO])
def test_a_method_alone_has_its_own_rungs_and_the_exact_tests(method):
    for system in (dayawansa_martin(6), lossy_network(), shears(Switching(fixed_ends=PAIR))):
        if method in applicable_methods(system):
            own = {rung.name for rung in LADDER if rung.method in {method, None}}
            asked = names(system, method, limits=Limits(max_degree=4))
            assert {re.sub(" of (degree|[0-9]+ steps?).*", "", name) for name in asked} <= own
            assert "every mode" in asked


def test_every_method_is_on_the_ladder():
    assert {rung.method for rung in LADDER} == {*Method, None} - {Method.AUTO}
    assert len({rung.name for rung in LADDER}) == len(LADDER)


@pytest.mark.parametrize("rung", LADDER, ids=lambda rung: rung.name)
def test_every_rung_names_a_search_that_there_is(rung):
    """A search is loaded when its rung is reached; a wrong name would be seen only then."""
    for named in filter(None, (rung.search, rung.cost, rung.lengths)):
        with pytest.raises(TypeError, match=rf"{named.__name__}\(\) missing"):
            named()


def test_degrees_rise_while_they_fit_into_what_is_left():
    allowance = Allowance(0.5)
    found = names(dayawansa_martin(6), Method.POLYNOMIAL, allowance=allowance)
    last = [name for name in found if name.startswith("polynomial")][-1]
    assert last.startswith("polynomial of degree")
    assert "polynomial of higher degree" in names(dayawansa_martin(6), Method.POLYNOMIAL)


@pytest.mark.parametrize("method", list(Method))
def test_no_method_proves_a_constant_parameter_by_its_ends(method):
    # Halfway between the two, the shears have the eigenvalue 4.
    system = shears(Switching(transitions=(), fixed_ends=(("m0", "m1"),)))
    try:
        found = certify(system, method, Limits(max_degree=4))
    except DesignError:
        return
    assert found.verdict is not Verdict.PROVED


@pytest.mark.parametrize("exponent", [12, 100, 200, 300])
def test_enormous_entries_end_in_words(exponent):
    big = 10**exponent
    modes = [[-big, 0], [1, -1]], [[-1, 1], [0, -big]]
    for switching in (Switching(), Switching(dwell_time=branicky().switching.dwell_time + 1)):
        assert certify(family(*modes, switching=switching), limits=Limits(max_degree=4)).attempts
