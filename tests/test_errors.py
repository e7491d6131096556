from pathlib import Path

import pytest

from nrs_design import errors
from nrs_design.errors import InternalError, NrsDesignError, SpecError

KINDS = [
    kind
    for kind in vars(errors).values()
    if isinstance(kind, type) and issubclass(kind, NrsDesignError)
]


def test_everything_in_one_line():
    error = SpecError("bad", path=Path("a.yaml"), line=3, column=7, remedy="mend it")
    assert str(error) == "a.yaml:3:7: bad (mend it)"
    assert (error.message, error.path, error.line, error.column) == ("bad", Path("a.yaml"), 3, 7)
    assert error.remedy == "mend it"


@pytest.mark.parametrize(
    ("place", "location"),
    [
        ({}, ""),
        ({"path": Path("a")}, "a"),
        ({"path": Path("a"), "line": 1}, "a:1"),
        ({"line": 1, "column": 2}, "1:2"),
    ],
)
def test_location_as_far_as_known(place, location):
    error = NrsDesignError("bad", **place)
    assert error.location == location
    assert str(error) == (f"{location}: bad" if location else "bad")


def test_rules_are_distinct():
    assert len({kind.rule for kind in KINDS}) == len(KINDS) >= 6
    assert all(kind.rule.startswith("NRS") and len(kind.rule) == 6 for kind in KINDS)


def test_a_defect_is_not_the_user_s_error():
    assert not issubclass(InternalError, NrsDesignError)
