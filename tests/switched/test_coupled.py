"""All axes of the thesis's robot at once: known answers, and motions by the equations of motion.

The rates were found by an independent program, with one multiplier for the inertia in all modes.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import AssemblyError
from nrs_design.search.certify import Limits, certify
from nrs_design.switched.assumptions import UNCOUPLED
from nrs_design.switched.coupled import AxesCoupling, couple_axes
from tests.proof.graphs import shape_of
from tests.search.support import thesis_robot
from tests.support import thinned

J = Fraction("1.213")
SOFT, BOTH, INSERTION = ("41.5", "44.2"), ("2.15", "1.04"), ("2.15",)
# A load against so much inertia is none: the reference leaves it out.
NO_LOAD = "1e30"


def inertia(share: str) -> Fraction:
    """Return the inertia of the links that makes an eigenvalue of ``(I + M/J)^-1``."""
    return J * (1 / Fraction(share) - 1)


# Eigenvalues of (I + M/J)^-1 in [0.8088, 0.9974].
LINKS = AxesCoupling(J, inertia("0.9974"), inertia("0.8088"))
MOVING = AxesCoupling(J, LINKS.lightest, LINKS.heaviest, Fraction("0.1"), "8 deg/s", Fraction(7))
ANY_RATE = Limits(optimize_rate=False)


@cache
def axes(Bt, coupling, load=NO_LOAD, **sections):
    return couple_axes(thesis_robot(SOFT, Bt, "0.01", load=load, **sections), coupling)


@cache
def evidence(Bt, coupling, contact):
    return certify(axes(Bt, coupling, contact=contact)).evidence


@pytest.mark.parametrize(
    ("Bt", "coupling", "contact", "rate"),
    [
        (BOTH, LINKS, "losable", 1.29),
        pytest.param(INSERTION, LINKS, "losable", 10.3, marks=pytest.mark.slow),
        pytest.param(BOTH, MOVING, "kept", 1.21, marks=pytest.mark.slow),
    ],
)
def test_rates_of_the_reference(Bt, coupling, contact, rate):
    found = evidence(Bt, coupling, contact)
    assert shape_of(found) == "coupled-axes"
    assert float(found.rate) == pytest.approx(rate, rel=0.02)


@pytest.mark.parametrize(
    ("Bt", "share", "verdict"),
    [
        (BOTH, "0.36", Verdict.PROVED),
        pytest.param(BOTH, "0.42", Verdict.INCONCLUSIVE, marks=pytest.mark.slow),
        (INSERTION, "1.44", Verdict.PROVED),
        (INSERTION, "1.7", Verdict.INCONCLUSIVE),
    ],
)
def test_how_heavy_links_may_be(Bt, share, verdict):
    """From none to a share of J; beyond it, no function is found."""
    coupling = AxesCoupling(J, Fraction(0), J * Fraction(share))
    assert certify(axes(Bt, coupling), limits=ANY_RATE).verdict is verdict


def test_links_of_one_weight_are_an_axis_of_that_weight():
    """Without a range, Lambda is a number: the row of omega times it, and no coupling."""
    system = axes(INSERTION, AxesCoupling(J, J, J), load="1.213")
    alone = thesis_robot(SOFT, INSERTION, "0.01", load="1.213")
    for heavy, light in zip(system.modes, alone.modes, strict=True):
        A, B = heavy.A.fractions(), light.A.fractions()
        assert A[1] == [entry / 2 for entry in B[1]]
        assert [A[0], *A[2:]] == [B[0], *B[2:]]
    (links,) = system.couplings
    assert not any(any(row.numerators[0]) for row in links.rows)


def test_the_bounds_by_hand():
    """J = 1, M from 0 to 1: Lambda in [1/2, 1], so 3/4 and 1/4."""
    coupling = AxesCoupling(
        Fraction(1), Fraction(0), Fraction(1), Fraction(2), "1 rad/s", Fraction(3)
    )
    alone = thesis_robot(SOFT, INSERTION, "0.01", load="1", contact="kept")
    system = couple_axes(alone, coupling)
    links, coriolis, gravity = system.couplings
    for k, mode in enumerate(alone.modes):
        turn = mode.A.fractions()[1]
        assert system.modes[k].A.fractions()[1] == [Fraction(3, 4) * entry for entry in turn]
        assert links.rows[k].fractions() == [[entry / 4 for entry in turn]]
        assert coriolis.rows[k].fractions() == [[0, 2, 0, 0]]
        assert gravity.rows[k].fractions() == [[0, 0, 0, 3]]
        for part in system.couplings:
            assert part.columns[k].fractions() == [[0], [1], [0], [0]]


def test_scaled_ranges_hold_each_other():
    mean = LINKS.scaled(Fraction(0))
    assert mean.lightest == mean.heaviest == (LINKS.lightest + LINKS.heaviest) / 2
    assert LINKS.scaled(Fraction(1)) == LINKS
    wide = MOVING.scaled(Fraction(2))
    assert wide.lightest == 0
    assert wide.heaviest > LINKS.heaviest
    assert (wide.coriolis, wide.gravity_gradient) == (Fraction("0.2"), 14)


def test_what_is_taken_for_granted():
    alone = thesis_robot(SOFT, BOTH, "0.01", load=NO_LOAD)
    assert UNCOUPLED in alone.assumptions
    system = axes(BOTH, LINKS)
    assert UNCOUPLED not in system.assumptions
    text = " ".join(system.assumptions)
    assert text.count("declared, not computed from a robot") == 1
    assert "the torque on an axis depends on the deflection of that axis alone" in text
    assert "Coriolis and centrifugal torques are left out." in text
    assert "Gravity is compensated in all poses" in text
    text = " ".join(axes(BOTH, MOVING, contact="kept").assumptions)
    assert text.count("declared, not computed from a robot") == 3
    assert "the speed stays below 8 deg/s, which is not shown" in text


def test_gravity_needs_contact_that_is_kept():
    with pytest.raises(AssemblyError, match="where contact is kept"):
        axes(BOTH, MOVING)


def test_axes_need_a_state_that_is_their_speed():
    canonical = thesis_robot(SOFT, BOTH, "0.01")
    with pytest.raises(AssemblyError, match="without a state omega"):
        couple_axes(canonical, LINKS)


def test_an_axis_that_is_unstable_by_itself_is_refuted():
    """Too stiff for withdrawal, whatever the others do."""
    stiff = thesis_robot(("41.5", "120"), ("1.04",), "0.01", load=NO_LOAD)
    found = certify(couple_axes(stiff, LINKS), limits=ANY_RATE)
    assert found.verdict is Verdict.REFUTED
    assert found.statements[0].names_unstable_mode
    assert "on which the others do not act" in found.statements[0].claim(found.system)


@pytest.mark.parametrize("contact", ["losable", "kept"])
@pytest.mark.parametrize("seed", thinned(range(30), 6))
def test_motions_of_three_axes_by_their_equations(contact, seed):
    """``(J I + M) q'' = J a - C q' - (G(q) - G(q0))`` with full matrices, and V falls at the rate.

    The axes are on different surfaces under different controllers, some of them in the air.
    """
    coupling = MOVING if contact == "kept" else LINKS
    system = axes(BOTH, coupling, contact=contact)
    item = proof(contact)
    generator = np.random.default_rng(seed)
    Q = np.array(item.nodes[0].form, dtype=float) / 2.0**item.denominator_log2
    M = symmetric(generator, float(coupling.lightest), float(coupling.heaviest))
    C, G = (
        rotation(generator) * float(size or 0)
        for size in (coupling.coriolis, coupling.gravity_gradient)
    )
    alone = thesis_robot(SOFT, BOTH, "0.01", load=NO_LOAD, contact=contact)
    rows = generator.standard_normal((3, 4)) * [0.01, 1, 1, 0.1]
    modes = generator.integers(len(alone.modes), size=3)
    moves = [np.array(alone.modes[k].A.floats()) @ x for k, x in zip(modes, rows, strict=True)]
    if contact == "losable":
        free = [np.array(mode.A.floats()) for mode in alone.contact.free]
        for i, x in enumerate(rows):
            if x[3] <= 0:
                moves[i] = free[generator.integers(len(free))] @ x
    moves = np.array(moves)
    torque = float(J) * moves[:, 1] - C @ rows[:, 1] - G @ rows[:, 3]
    moves[:, 1] = np.linalg.solve(float(J) * np.eye(3) + M, torque)
    w, moved = rows.copy(), moves.copy()
    if contact == "losable":
        flying = rows[:, 3] <= 0
        w[flying, 3] = moved[flying, 3] = 0.0
    value, rise = np.einsum("ai,ij,aj", w, Q, w), 2 * np.einsum("ai,ij,aj", w, Q, moved)
    assert rise <= -2 * float(item.rate) * value
    assert system.couplings


def proof(contact):
    return evidence(BOTH, MOVING if contact == "kept" else LINKS, contact)


def symmetric(generator, low, high):
    """Return a symmetric matrix with eigenvalues at both ends of a range, and one inside."""
    V = rotation(generator)
    return V @ np.diag([low, high, generator.uniform(low, high)]) @ V.T


def rotation(generator):
    return np.linalg.qr(generator.standard_normal((3, 3)))[0]
