"""The points of a sweep, as a spec writes them, and their answers as a table."""

from itertools import product

import pytest

from nrs_design.errors import NrsDesignError, SpecError
from nrs_design.pipeline.sweep_grid import parse_values, read_grid
from nrs_design.pipeline.sweep_table import cell_text, choose_facts, facts_in, flat, telling
from tests.support import COMMUTING, SOFT_TISSUE
from tests.tables import rows

LEVER = "environments.soft.lever_arm=0.2,0.3 m"
STIFFNESS = "environments.soft.stiffness=100..400/4 N/m"


def test_every_combination_once_and_the_last_field_fastest():
    grid = read_grid(SOFT_TISSUE, [LEVER, STIFFNESS])
    stiffness = [f"{value} N/m" for value in (100, 200, 300, 400)]
    assert grid.points == list(product(["0.2 m", "0.3 m"], stiffness))
    assert grid.changes(grid.points[0]) == (
        (("environments", "soft", "lever_arm"), "0.2 m"),
        (("environments", "soft", "stiffness"), "100 N/m"),
    )


def test_items_of_lists_are_counted_from_0():
    grid = read_grid(COMMUTING, ["modes.1.A.0.0=-1,-2"])
    assert grid.changes(grid.points[1]) == ((("modes", 1, "A", 0, 0), "-2"),)


def test_the_unit_above_a_column():
    first, second = read_grid(SOFT_TISSUE, [STIFFNESS, "limits.torque=1 N*m,2 kN*m"]).fields
    assert (first.unit, second.unit) == ("N/m", "")


@pytest.mark.parametrize(("said", "message"), rows(__file__, "test_what_makes_no_grid"))
def test_what_makes_no_grid(said, message):
    with pytest.raises(SpecError, match=message):
        read_grid(SOFT_TISSUE, said)


@pytest.mark.parametrize(("text", "values"), rows(__file__, "test_values"))
def test_values(text, values):
    assert list(parse_values(text)) == values


REFUSED = (
    "|,|1,|2..1/3 N|1..1/2 N|1..2/0 N|1..2/99999 N|1..2/1|1..2|1...2 N|a..b|1..2/-3|1..|[1, 2]"
    "|1,2,1 N"
)


@pytest.mark.parametrize("text", REFUSED.split("|"))
def test_what_has_no_values_is_refused(text):
    with pytest.raises(SpecError):
        parse_values(text)


def test_items_are_called_by_their_names():
    document = {
        "spec_sha256": "ab",
        "controllers": [{"name": "in", "Mt": 1.5}, {"name": "out", "Mt": None}],
        "modes": ["a", "b"],
        "empty": [],
    }
    assert dict(flat(document)) == {
        "controllers.in.Mt": 1.5,
        "controllers.out.Mt": None,
        "modes.0": "a",
        "modes.1": "b",
    }


def test_a_fact_tells_if_it_differs_and_is_short():
    rows = [
        {"same": 1, "rate": 0.1, "said": "a" * 30, "rate_exact": "1/10"},
        {"same": 1, "rate": 0.2, "said": "b" * 30, "rate_exact": "1/5", "late": 1},
        {"same": 1, "rate": 0.2, "late": 1},
    ]
    assert facts_in(rows) == ["same", "rate", "said", "rate_exact", "late"]
    assert telling(rows) == telling([*rows, {}]) == ["rate", "late"]


def test_facts_are_chosen_by_how_they_end():
    rows = [{"a.Mt": 1, "a.Bt": 2, "b.Bt": 3, "a.optimum.Bt": 4, "verdict": "proved"}]
    assert choose_facts(rows, ["Bt", "verdict", "a.Bt"]) == ["a.Bt", "b.Bt", "verdict"]
    with pytest.raises(NrsDesignError, match="no answer has a fact 'Bx'"):
        choose_facts(rows, ["Bx"])


def test_cells():
    values = {None: "-", True: "yes", False: "no", 1 / 3: "0.333333", 7: "7", "a": "a"}
    assert {value: cell_text(value) for value in values} == values
