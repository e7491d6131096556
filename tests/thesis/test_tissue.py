"""Chapter 2.5 and section 6.1."""

import pytest

from nrs_design.thesis import specimens, tissue
from nrs_design.thesis.table import topic_rows


def find(rows, name):
    (row,) = [row for row in rows if row.name == name]
    return row


# Recomputed from the printed coefficients.
@pytest.mark.parametrize(
    ("name", "value", "verdict"),
    [
        ("relaxation time b/k of the Maxwell nose", "106.495", "derived"),
        ("relaxation time b/k of the Maxwell concha", "39.6605", "derived"),
        ("b/k of the Kelvin-Voigt nose", "1.66341", "derived"),
        ("b/k of the Kelvin-Voigt concha", "1.66725", "derived"),
        ("law with the largest mean RMSE, nose", "elastic (0.0142 N m)", "printed differently"),
        ("law with the largest mean RMSE, concha", "Maxwell (0.0147 N m)", "printed differently"),
    ],
)
def test_tissue(name, value, verdict):
    row = find(topic_rows(tissue), name)
    assert (row.value, row.verdict) == (value, verdict)


def test_maxwell_is_best_on_the_nose():
    note = find(topic_rows(tissue), "law with the largest mean RMSE, nose").note
    assert "Maxwell (0.0130 N m)" in note


def test_printed_coefficients_without_elements():
    rows = topic_rows(specimens)
    assert {row.verdict for row in rows} == {
        "reproduced",
        "printed differently",
        "derived",
        "not reproducible",
    }
    without = {row.name for row in rows if row.value and row.value.startswith("no such law: ")}
    assert without == {f"k1, k2, b of the stiff specimen, experiment {i}" for i in (2, 3)}
