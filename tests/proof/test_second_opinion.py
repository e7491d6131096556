"""Flint's veto: it agrees on everything that is right, and stops everything else."""

import flint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.errors import InternalError
from nrs_design.proof.evidence import UnstableMode
from nrs_design.proof.exact import is_positive_definite
from nrs_design.proof.second_opinion import agrees, has_positive_spectrum
from nrs_design.proof.system import Time
from nrs_design.search.certify import certify
from tests.proof.systems import genuine
from tests.support import family

INTS = st.integers(-9, 9)
STABLE = family([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])
UNSTABLE = family([[-1, 0], [0, -2]], [[0, 1], [-1, 0]])


@settings(deadline=None)
@given(st.sampled_from([1, 4, 9, 16, 25]).flatmap(lambda k: st.lists(INTS, min_size=k, max_size=k)))
def test_descartes_agrees_with_bareiss(entries):
    n = round(len(entries) ** 0.5)
    M = [
        [entries[i * n + j] + entries[j * n + i] + 12 * (i == j) for j in range(n)]
        for i in range(n)
    ]
    assert has_positive_spectrum(flint.fmpz_mat(M)) == is_positive_definite(M)


def test_no_proof_without_flint(monkeypatch):
    class Upset:
        def __init__(self, rows):
            self.n = len(rows)

        def charpoly(self):
            return flint.fmpz_poly([1] * self.n + [1])

    monkeypatch.setattr(flint, "fmpz_mat", Upset)
    with pytest.raises(InternalError, match="disagree"):
        certify(STABLE)


def test_no_refutation_without_flint(monkeypatch):
    evidence = certify(UNSTABLE).evidence

    class Calm:
        def __init__(self, rows):
            pass

        def charpoly(self):
            return flint.fmpz_poly([1, 1])

    monkeypatch.setattr(flint, "fmpz_mat", Calm)
    assert not agrees(UNSTABLE, evidence)
    with pytest.raises(InternalError, match="disagree"):
        certify(UNSTABLE)


def test_veto_on_a_stable_mode_called_unstable():
    assert not agrees(STABLE, UnstableMode("m0", "0"))
    discrete = family([["1/2"]], time=Time.DISCRETE)
    assert not agrees(discrete, UnstableMode("m0", "0"))


@pytest.mark.parametrize(
    "example", ["mode-quadratic, dwell", "mode-quadratic, left in time", "unstable-period"]
)
def test_no_exponential_without_a_taylor_series(monkeypatch, example):
    """An enclosure by flint that is a little off meets with a veto."""
    system, evidence = genuine(example)
    assert agrees(system, evidence)
    exp = flint.arb_mat.exp

    class Off(flint.arb_mat):
        def exp(self):
            return exp(self) * (1 + flint.arb(2) ** -150)

    monkeypatch.setattr(flint, "arb_mat", Off)
    assert not agrees(system, evidence)
