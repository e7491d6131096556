"""The whole table: what the thesis prints in chapters 3, 4 and 6."""

from types import SimpleNamespace

import numpy as np
import pytest

from nrs_design.thesis import formulas, loops, table, thesis
from nrs_design.thesis.comparison import PrintVerdict, errata, meets_standard
from nrs_design.thesis.formulas import CHECKS
from nrs_design.thesis.table import reproduce, topic_rows


@pytest.fixture(scope="module")
def find(rows):
    def one(name, section):
        (row,) = [row for row in rows if (row.name, row.section) == (name, section)]
        return row

    return one


def test_the_printed_arms_do_not_give_the_printed_masses(find):
    """Moments about C and A by hand, with 115 and 220 mm and the 75.4 mm of the right arm."""
    M_c = (442.8 * 200 + 112.1 * 75.4) / 115
    M_b = ((442.8 + 112.1 + M_c) * 195 + 116.1 * 107.2) / 220
    assert find("M_c, right leg", "4.4").note == (
        f"With the printed arms, 115 and 220 mm, it is {M_c:.1f} g."
    )
    assert f"{M_b:.1f} g" in find("M_b, right leg", "4.4").note


def test_one_standard_for_all_prints(rows):
    """A number is wrong only where its deviation is larger than that of every reproduced one."""
    numbers = [row for row in rows if row.deviation is not None]
    assert len(numbers) > 60
    for row in numbers:
        values = tuple(map(number, row.value.split(", ")))
        assert row.precision
        assert row.limit
        if row.verdict is not PrintVerdict.FITTED:
            reproduced = row.verdict is PrintVerdict.REPRODUCED
            assert meets_standard(values, tuple(row.printed.split(", "))) == reproduced, row


def number(text):
    real, pair, imaginary = text.partition(" +- ")
    return complex(float(real), float(imaginary.removesuffix("j"))) if pair else float(real)


@pytest.mark.parametrize("index", range(6))
def test_limits_of_table_7_1_by_eigenvalues(find, index):
    """The characteristic polynomial by hand: s D(s) (Mt s + Bt) + k N(s) = 0."""
    row = find("largest stable stiffness of the hand, each experiment", "table 7.1")
    limit = float(row.value.split(", ")[index])
    Mt, Bt = loops.ADMITTANCES[index]
    free = np.polymul([Mt, Bt, 0], thesis.EXACT_LOOP.denominator)
    rightmost = [
        np.roots(
            np.polyadd(free, factor * limit * np.array(thesis.EXACT_LOOP.numerator))
        ).real.max()
        for factor in (0.999, 1.001)
    ]
    assert rightmost[0] < 0 < rightmost[1]


def test_a_changed_computation_becomes_a_drift(monkeypatch):
    biased = SimpleNamespace(Mt=0.01, Bt=2.16)
    monkeypatch.setattr(loops, "optimize_impedance", lambda problem: biased)
    drifts = {row.name for row in topic_rows("impedance") if row.verdict is PrintVerdict.DRIFT}
    assert "Mt, Bt: soft, Mt >= 0.01; G exact" in drifts
    assert "k_soft" not in drifts


def test_a_topic_is_added_in_one_place(monkeypatch):
    monkeypatch.setattr(table, "read_data", lambda name: ["actuator"])
    names: list[str] = []
    assert reproduce(names.append) == topic_rows("actuator")
    assert names == ["actuator"]


def test_every_erratum_has_a_row_and_every_row_a_known_erratum(rows):
    touched = {one for row in rows for one in row.errata}
    assert touched == {one.id for one in errata()}


def test_what_is_printed_differently_names_its_error(rows):
    wrong = [row for row in rows if row.verdict is PrintVerdict.PRINTED_DIFFERENTLY]
    assert [row.name for row in wrong if not row.errata] == []


@pytest.mark.parametrize("name", CHECKS)
def test_a_formula_that_no_longer_holds_is_a_drift(name, monkeypatch):
    monkeypatch.setattr(formulas, "CHECKS", {**CHECKS, name: lambda: False})
    drifts = [row for row in topic_rows("formulas") if row.verdict is PrintVerdict.DRIFT]
    assert len(drifts) == 1
    assert name in drifts[0].section


def test_the_checks_tell_the_print_from_what_is_right(monkeypatch):
    """With another power in 2.15, other arms in 4.18 and another sign in 6.21 they fail."""
    monkeypatch.setattr(formulas.thesis, "SETTLING_TIME", 0.2)
    assert not CHECKS["4.25"]()
    monkeypatch.setattr(formulas.thesis, "DAMPING_RATIO", 0.5)
    assert not CHECKS["4.24"]()
    monkeypatch.setattr(formulas, "printed_rows", lambda *entries: [[-1]])
    assert not CHECKS["5.18"]()
    monkeypatch.setattr(formulas, "impedance_rows", lambda *given: [[-1, 0, 0, 0]] * 4)
    assert not CHECKS["6.21"]()
