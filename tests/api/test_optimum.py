"""`Study.optimize`: floats with units, as a student takes them into a notebook."""

import json
import math

import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError
from tests.support import COMMUTING, ROOT, SOFT_TISSUE


def test_gains_and_margins_of_the_thesis():
    optimum = nrs.load(SOFT_TISSUE).optimize()
    assert optimum.gains["insertion"] == pytest.approx({"Mt": 0.01, "Bt": 2.15})
    assert optimum.units["insertion"] == {"Mt": "kg*m^2", "Bt": "N*m*s/rad"}
    # Reference: 3.75298, by Sturm chains on the family.
    assert optimum.margins["withdrawal"]["max_sensitivity_peak"] == pytest.approx(3.75298, abs=1e-4)
    assert optimum.cost["insertion"] == pytest.approx(0.1552, abs=1e-4)
    assert str(optimum).startswith("insertion: Mt = 0.01 kg*m^2, Bt = 2.15 N*m*s/rad\n")
    assert "<td>withdrawal</td>" in optimum._repr_html_()


def test_matrices_have_nothing_to_optimize():
    with pytest.raises(DesignError, match="has nothing to optimize"):
        nrs.load(COMMUTING).optimize()


def test_what_nothing_limits_is_null_in_json():
    """A controller of position has margins without end, and no gain of its own."""
    optimum = nrs.load(ROOT / "docs/examples/mixed-controllers.nrs.yaml").optimize()
    assert any(math.isinf(v) for found in optimum.margins.values() for v in found.values())
    assert json.dumps(optimum.to_dict(), allow_nan=False)
    assert "approach: no gain" in str(optimum)
