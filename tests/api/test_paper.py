import numpy as np
import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError

STABLE = [[[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]]]
# Dayawansa and Martin 1999: no quadratic function.
PAIR = [[[-1, -1], [1, -1]], [[-1, -6], ["1/6", -1]]]


def test_p_decreases_along_every_mode():
    decision = nrs.certify(STABLE)
    P = decision.P
    assert P is not None
    for A in np.array(STABLE, float):
        assert np.linalg.eigvalsh(A.T @ P + P @ A).max() < 0
    assert r"\begin{bmatrix}" in decision.latex()
    assert r"\alpha \ge 0.99" in decision.latex()


def test_what_is_no_quadratic_function_has_no_p():
    decision = nrs.certify(PAIR)
    assert decision.P is None
    assert "bmatrix" not in decision.latex()
    assert nrs.certify([[[1]]]).latex() == "% switched-system: refuted"


def test_large_and_small_numbers_are_powers_of_ten():
    assert r"\cdot 10^{" in nrs.certify([[["-1e-7"]]]).latex()


def test_a_figure_in_the_width_of_a_column():
    decision = nrs.certify(STABLE)
    assert decision.plot(width="ieee").get_size_inches()[0] == 3.5
    with pytest.raises(DesignError, match="no width 'wide'"):
        decision.plot(width="wide")


def test_facts_are_plain():
    facts = nrs.certify(STABLE).to_dict()
    assert facts["verdict"] == "proved"
    assert isinstance(facts["decay_rate"], str)
