"""Evidence of kind unstable-mixture: what an average refutes, and when it may be formed."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import UnstableMixture, read_evidence
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Verdict, certify
from nrs_design.search.method import Method
from tests.proof.systems import family, genuine, resets_between, shears
from tests.support import ends_soon

HALF = Fraction(1, 2)


def mixed(*weights):
    return UnstableMixture(tuple((f"m{i}", Fraction(w)) for i, w in enumerate(weights)), "")


def test_two_shears_by_hand():
    # [[-1, 5], [5, -1]] has the eigenvalues 4 and -6.
    assert mixed(HALF, HALF).find_fault(shears()) is None
    assert certify(shears(), Method.MIXTURE).verdict is Verdict.REFUTED


def test_an_average_on_the_border_counts():
    # [[-1, s], [s, -1]] with s = 1 has the eigenvalue 0: not Hurwitz, so not uniformly stable.
    border = family([[-1, 2], [0, -1]], [[-1, 0], [2, -1]])
    assert mixed(HALF, HALF).find_fault(border) is None
    inside = family([[-1, "1.999999"], [0, -1]], [[-1, 0], ["1.999999", -1]])
    assert mixed(HALF, HALF).find_fault(inside) is not None


@pytest.mark.parametrize(
    "weights", [(HALF,), (1, 1), (0, 1), (Fraction(3, 2), -HALF), (), (HALF, HALF, 0)]
)
def test_weights_are_positive_with_sum_one(weights):
    rows = [mode.A.fractions() for mode in shears().modes]
    assert mixed(*weights).find_fault(family(*rows, rows[0])) is not None


def test_names_are_those_of_modes_and_occur_once():
    for names in (("m0", "m0"), ("m0", "m7")):
        evidence = UnstableMixture(tuple((name, HALF) for name in names), "")
        assert evidence.find_fault(shears()) is not None
    # Even where the mode that is named twice is not stable.
    unstable = family([[1]], [[-1]])
    twice = UnstableMixture((("m0", HALF), ("m0", HALF)), "")
    assert twice.find_fault(unstable) == "the weights are not those of modes"
    thrice = {"kind": "unstable-mixture", "weights": [["m0", "1/3"]] * 3}
    with pytest.raises(ValueError, match="too many weights"):
        read_evidence(thrice, unstable)


@pytest.mark.parametrize(
    ("denominator", "fault"), [(2**64, None), (2**64 + 1, "the weights have too many digits")]
)
def test_digits_of_weights_are_limited(denominator, fault):
    share = Fraction(2**63 + 1, denominator)
    assert mixed(share, 1 - share).find_fault(shears()) == fault


@pytest.mark.parametrize("weights", [("2",), ("1/2", "3/2"), ("1e9", "1")])
def test_no_weight_in_a_file_is_above_one(weights):
    named = [[f"m{i}", weight] for i, weight in enumerate(weights)]
    with pytest.raises(ValueError, match=r"digits|ratio"):
        read_evidence({"kind": "unstable-mixture", "weights": named}, shears())


@pytest.mark.parametrize(
    "switching",
    [
        Switching(Fraction(1, 10**9)),
        Switching(transitions=(("m0", "m1"), ("m1", "m0"))),
        Switching(resets=resets_between(("m0", "m1", [[1, 0], [0, 1]]))),
        Switching(fixed_ends=(("m0", "m1"),)),
    ],
)
def test_it_needs_arbitrarily_fast_switching(switching):
    evidence = mixed(HALF, HALF)
    assert "switching" in str(evidence.find_fault(shears(switching)))


def test_discrete_time_has_no_mixtures():
    # The average of these two is not Schur, yet every product of two of them is zero or small.
    system = family([["1/2", 8], [0, "1/2"]], [["1/2", 0], [8, "1/2"]], time=Time.DISCRETE)
    assert "continuous" in str(mixed(HALF, HALF).find_fault(system))


def test_a_rewritten_eigenvalue_is_computed_again():
    system, evidence = genuine("unstable-mixture")
    fields = {"kind": evidence.kind, **evidence.to_fields(), "eigenvalue": "1e9"}
    assert read_evidence(fields, system).to_fields()["eigenvalue"] == evidence.eigenvalue


def test_weights_that_are_too_long_are_rejected_at_once():
    n = 32
    A = [[(i * 7 + j * 3) % 5 - 2 - 9 * (i == j) for j in range(n)] for i in range(n)]
    system = family(A, [list(row) for row in zip(*A, strict=True)])
    odd = 10**1000 + 1
    weights = (("m0", Fraction(odd // 2, odd)), ("m1", 1 - Fraction(odd // 2, odd)))
    with ends_soon():
        assert "digits" in str(UnstableMixture(weights, "").find_fault(system))
        fields = {"kind": "unstable-mixture", "weights": [[m, str(w)] for m, w in weights]}
        with pytest.raises(ValueError, match="digits"):
            read_evidence(fields, system)


def test_an_unknown_mode_in_a_file_is_no_crash():
    with pytest.raises(KeyError):
        read_evidence({"kind": "unstable-mixture", "weights": [["m9", "1"]]}, shears())
    assert replace(mixed(1), weights=(("m9", Fraction(1)),)).find_fault(shears()) is not None


def test_numbers_that_would_take_minutes_are_refused():
    half = (("m0", Fraction(1, 2)), ("m1", Fraction(1, 2)))
    evidence = UnstableMixture(half, "1")
    ones = ((1, 0), (0, 1))
    coprime = RationalMatrix(ones, 2**60_000), RationalMatrix(ones, 3**40_000)
    long = RationalMatrix(((2**400_000, 1), (0, 1))), RationalMatrix(ones)
    for matrices in (coprime, long):
        modes = tuple(Mode(f"m{i}", A) for i, A in enumerate(matrices))
        system = replace(shears(), modes=modes)
        fault = evidence.find_fault(system)
        assert fault == "the numbers of the combination are too large to check"
        with pytest.raises((ValueError, TooLargeError), match="too large"):
            UnstableMixture.from_fields(evidence.to_fields(), system)
