from fractions import Fraction

import numpy as np

import nrs_design as nrs
from nrs_design.api.paper import latex_of_gains, latex_of_ranges

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


def test_a_gain_that_is_rounded_is_said_to_be():
    gains = {"insertion": {"Bt": "2.150000095367431640625", "Kd": "2060"}}
    units = {"insertion": {"Bt": "N*m*s/rad", "Kd": "rpm*s/rad"}}
    shown = latex_of_gains(gains, units)
    assert r"$B_{\mathrm{t}} \approx 2.15\,\mathrm{N\,m\,s/rad}$" in shown
    assert r"$K_{\mathrm{d}} = 2060\,\mathrm{rpm\,s/rad}$" in shown


def test_ends_of_a_range_are_rounded_outwards():
    ranges = [("k", 685.8776, 809.0161, "N/m"), ("time_constant", 0.0, float("inf"), "s")]
    first, second = latex_of_ranges(ranges).splitlines()
    assert first == r"$k \in [685.8,\, 809.1]\,\mathrm{N/m}$"
    assert second == r"$\mathrm{time\ constant} \in [0,\, \infty]\,\mathrm{s}$"


def test_facts_are_plain():
    facts = nrs.certify(STABLE).to_dict()
    assert facts["verdict"] == "proved"
    # The double is on the side that is proved.
    assert facts["decay_rate"] <= Fraction(facts["decay_rate_exact"])
