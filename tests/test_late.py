"""What is imported when it is first used: names of a package, and functions."""

import pytest

from nrs_design.late import late_function, late_names
from nrs_design.proof import evidence
from nrs_design.proof.evidence.growing_sequence import GrowingSequence


def test_a_name_is_found_in_its_home():
    find = late_names("nrs_design.proof.evidence", {"growing_sequence": "GrowingSequence"})
    assert find("GrowingSequence") is GrowingSequence


def test_a_name_without_a_home_is_none_of_the_package():
    with pytest.raises(AttributeError, match="has no attribute 'x'"):
        late_names("nrs_design.proof", {"exact": "exact"})("x")
    assert not hasattr(evidence, "NothingOfTheKind")


def test_a_function_is_called_with_all_that_it_is_given():
    power = late_function("nrs_design.proof.evidence.flow", "power")
    assert power.__name__ == "power"
    assert late_function("builtins", "sorted")([1, 3, 2], reverse=True) == [3, 2, 1]


@pytest.mark.parametrize("kind", evidence.KINDS)
def test_every_kind_is_in_the_table_under_its_own_name(kind):
    found = evidence.class_of(kind)
    assert found.kind == kind
    assert found.__name__ == evidence.KINDS[kind]
    assert getattr(evidence, found.__name__) is found
