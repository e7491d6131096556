"""What is decided about matrices of the user's own."""

from decimal import Decimal
from fractions import Fraction

import control
import cvxpy as cp
import numpy as np
import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError, NrsDesignError, SpecError
from tests.api.pairs import ROTATION, pair
from tests.tables import rows


def test_ways_to_give_the_same_modes():
    texts = nrs.certify([[["-1", "-1"], ["1", "-1"]], [["-1", "-5"], ["1/5", "-1"]]])
    exact = nrs.certify({"m1": ROTATION, "m2": pair(5)[1]})
    assert texts.decay_rate == exact.decay_rate
    floats = nrs.certify([np.array(ROTATION), np.array([[-1, -5], [0.2, -1]])])
    (_, second) = floats.result.certification.system.modes
    assert second.A.fractions()[1][0] == Fraction(0.2) != Fraction(1, 5)


def test_state_spaces_decide_the_time():
    # Ando and Shih 1998, scale 0.7: stable in discrete time.
    matrices = ([[0.7, 0], [0.7, 0]], [[0, 0.7], [0, -0.7]])
    sampled = [control.ss(A, [[0], [0]], [[0, 0]], 0, 0.002) for A in matrices]
    decision = nrs.certify(sampled)
    assert decision.verdict == "proved"
    assert 0 < decision.decay_rate < 1
    assert "x+ = A x" in decision.claim


def test_constrained_switching():
    # Geromel and Colaneri 2006: stable from a dwell time of about 2.75 s on.
    modes = {"a": [[0, 1], [-10, -1]], "b": [[0, 1], ["-0.1", "-0.5"]]}
    assert nrs.certify(modes, dwell_time="2.76 s").verdict == "proved"
    assert nrs.certify(modes, dwell_time=2).verdict == "refuted"
    assert nrs.certify(modes, transitions=[]).verdict == "proved"


def test_resets_and_parameters():
    decay = {"a": [[-1]], "b": [[-2]]}
    halves = {("a", "b"): [[0.5]], ("b", "a"): [[0.5]]}
    assert nrs.certify(decay, resets=halves).verdict == "proved"
    stretched = nrs.certify([[["-1 - k", 0], [0, -1]]], parameters={"k": (0, 1)})
    assert stretched
    nominal = {"nominal": 0, "range": (0, "1/3"), "varies": "false"}
    assert nrs.certify([[["-1 - k"]]], parameters={"k": nominal}).verdict == "proved"


def test_stays_of_single_modes():
    """An unstable mode that is left in time, and a stable one that lasts: exp(0.5 - 1) < 1."""
    modes = {"up": [[1]], "down": [[-1]]}
    rules = {"longest_dwell_time": {"up": "0.5 s"}, "dwell_time": {"down": 1}}
    assert nrs.certify(modes, **rules).verdict == "proved"
    assert nrs.certify(modes, **(rules | {"dwell_time": {"down": 0.25}})).verdict == "refuted"


def test_several_resets_between_two_modes():
    """Either of them may happen, so the growing one decides."""
    modes, small, large = [[[-1]], [[-2]]], np.array([[0.5]]), [[3]]
    both = {("m1", "m2"): [small, large], ("m2", "m1"): [[1]]}
    assert nrs.certify(modes, resets=both | {("m1", "m2"): small}).verdict == "proved"
    for maps in ([small, large], (large, small), [[["0.5"]], large]):
        assert nrs.certify(modes, resets=both | {("m1", "m2"): maps}).verdict == "refuted"


def test_names_may_be_numbers():
    rules = {"dwell_time": {1: 2}, "transitions": [(1, 2)], "resets": {(1, 2): [[3]]}}
    assert nrs.certify({1: [[-1]], 2: [[-2]]}, **rules).verdict == "proved"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        *rows(__file__, "test_wrong_input_is_told_in_words"),
        (([control.tf([1], [1, 1])],), r"m1 is not a matrix .*control\.ss"),
        (([[[Decimal("NaN")]]],), "NaN"),
    ],
)
def test_wrong_input_is_told_in_words(arguments, said):
    with pytest.raises(SpecError, match=said) as caught:
        nrs.certify(*arguments)
    assert caught.value.line is None


def test_wrong_options():
    with pytest.raises(SpecError, match="two ends"):
        nrs.certify([[["k"]]], parameters={"k": 3})
    with pytest.raises(SpecError, match="comma"):
        nrs.certify([[["1,5"]]])
    with pytest.raises(SpecError, match="time"):
        nrs.certify([[[-1]]], time="now")
    with pytest.raises(SpecError, match="there is no mode"):
        nrs.certify([[[-1]], [[-2]]], transitions=[("m1", "m9")])
    for transitions in (["m1", "m2"], "m1"):
        with pytest.raises(SpecError, match="expected two names"):
            nrs.certify([[[-1]], [[-2]]], transitions=transitions)
    for resets in ({"m1": [[1]]}, [("m1", "m2", [[1]])]):
        with pytest.raises(SpecError, match="named by two modes"):
            nrs.certify([[[-1]], [[-2]]], resets=resets)
    for option in ({"budget": -1}, {"budget": float("nan")}, {"max_degree": 0}):
        with pytest.raises(DesignError, match=f"{next(iter(option))} is"):
            nrs.certify([[[-1]]], **option)


def test_a_variable_of_cvxpy_is_told_from_its_value():
    P = cp.Variable((2, 2), symmetric=True)
    with pytest.raises(SpecError, match="P is not a matrix") as caught:
        nrs.check_lyapunov(pair(5), P)
    assert "give its .value" in caught.value.remedy
    P.value = np.diag([1.0, 5.0])
    assert nrs.check_lyapunov(pair(5), P.value).holds


@pytest.mark.parametrize(
    "matrix", [-np.eye(2), [[-1, 0], [0, -1]], control.ss(-np.eye(2), np.eye(2), np.eye(2), 0)]
)
def test_one_matrix_is_no_list_of_modes(matrix):
    for ask in (nrs.certify, lambda modes: nrs.check_lyapunov(modes, [[1, 0], [0, 1]])):
        with pytest.raises(SpecError, match="one matrix") as caught:
            ask(matrix)
        assert "[A]" in caught.value.remedy
    assert nrs.certify([matrix])


def test_check_lyapunov_says_where_it_fails():
    good = nrs.check_lyapunov(pair(5), [[1, 0], [0, 5]])
    assert good
    bad = nrs.check_lyapunov(pair(5), np.eye(2))
    assert not bad
    assert bad.counterexample.mode == "m2"
    # Only the symmetric part of P counts.
    assert nrs.check_lyapunov(pair(5), [[1, 1], [-1, 5]]) == good
    with pytest.raises(SpecError, match="P is not a matrix"):
        nrs.check_lyapunov(pair(5), 3)
    for P, said in (
        ([[1, 0]], "P is 1 x 2, not square"),
        ([[1]], "P is 1 x 1, and not every mode"),
    ):
        with pytest.raises(NrsDesignError, match=said):
            nrs.check_lyapunov(pair(5), P)


def test_check_lyapunov_says_why_in_words():
    holding = nrs.check_lyapunov({"a": [[0, 1], [-2, -3]]}, [[5, 1], [1, 1]])
    assert next(holding.lines()).startswith("HOLDS: ")
    # x' = -x decays, though not at the rate 2: nobody may read that it does not.
    slow = " ".join(nrs.check_lyapunov({"a": [[-1]]}, [[1]], "2").lines())
    for said in (
        "in mode a it does not decrease at this rate",
        "x' (A'P + PA + 2 alpha P) x = 2",
        "decreases strictly in every mode, proved at alpha >= 0.999",
    ):
        assert said in slow


@pytest.mark.parametrize("time", ["continuous", "discrete"])
def test_a_constant_parameter_beside_modes_of_unequal_size(time):
    """No function that is affine in it is looked for; that ended in an IndexError."""
    decision = nrs.certify(
        {"a": [["-k", 0], [0, "-k"]], "b": [["-k"]]},
        time=time,
        resets={("a", "b"): [["1/2", 0]], ("b", "a"): [["1/2"], [0]]},
        parameters={"k": {"nominal": "1/2", "range": ("1/3", "2/3"), "varies": False}},
        budget=2,
    )
    assert decision.verdict in ("proved", "inconclusive")
    assert "constants quadratic" not in {attempt.step for attempt in decision.attempts}
