"""Steps with rounded arithmetic: known answers, attacks, and what each condition bars."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.certificates.second_opinion import agrees
from nrs_design.proof.channels import Channel, Output, Rounding
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import InvariantEllipsoid
from nrs_design.proof.evidence.abstract import ROUNDED
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import Acting, flow_step, map_step, multiplier_names
from nrs_design.proof.system import SwitchedSystem
from tests.proof import truth
from tests.proof.graphs import common_quadratic, forms_of_steps
from tests.proof.systems import Entry, bouncing, bouncing_in_steps, crowded, family, matrix

ONE = Fraction(1)


def rounded(A: Entry, share: Entry, column: Entry = 1) -> SwitchedSystem:
    """One state, ``x+ = A x + C r`` with ``|r| <= share |x|``."""
    rounding = Rounding("a x", (matrix([[column]]),), (matrix([[share]]),))
    return replace(family([[A]], time=Time.DISCRETE), roundings=(rounding,))


def test_the_exact_rate_of_one_state():
    """x+ = x/2 + r with |r| <= |x|/4 grows by 3/4 at worst, and no multiplier shows less."""
    system = rounded("1/2", "1/4")
    proof = common_quadratic(((1,),), 0, Fraction("0.7501"), (3,))
    assert proof.find_fault(system) is None
    assert agrees(system, proof)
    assert truth.holds(system, proof)
    assert proof.claim(system).endswith(ROUNDED)
    for tau in range(20):
        fast = common_quadratic(((8,),), 3, Fraction("0.7499"), (tau,))
        assert "does not decrease" in fast.find_fault(system)


def test_a_disturbance_is_rounded_too():
    """z+ = z/2 + d + r, |r| <= |d|/2: from rest up to 3; no set below shows it."""
    system = replace(
        family([["1/2"]], time=Time.DISCRETE),
        channels=(Channel("d", "", ONE, (matrix([[1]]),)),),
        outputs=(Output("z", "", (matrix([[1]]),)),),
        roundings=(Rounding("d", (matrix([[1]]),), (matrix([[0, "1/2"]]),)),),
    )
    scale = 2**20

    def candidate(reach: Fraction, tau: Fraction) -> InvariantEllipsoid:
        Q, half = int(scale / reach**2), (Fraction(1, 2),)
        return InvariantEllipsoid(
            ("d",), "z", ((Q,),), 20, half, Fraction(4), (), (int(scale * tau),)
        )

    # At the border, tau = 2/9 of the part of r in the worst push.
    found = [
        t
        for t in range(1, 200)
        if candidate(Fraction("3.01"), Fraction(t, 200)).find_fault(system) is None
    ]
    assert found
    assert agrees(system, candidate(Fraction("3.01"), Fraction(found[0], 200)))
    for t in range(1, 200):
        assert candidate(Fraction("2.99"), Fraction(t, 200)).find_fault(system) is not None


Q3 = ((9, 2, -1), (2, 7, 3), (-1, 3, 8))
WEIGHTS = (Fraction(2, 3), Fraction(3, 5))


@pytest.mark.parametrize("acting", [(), (2, 0)])
def test_errors_of_a_flow_by_hand(acting):
    """No system with these makes sense, as nothing is rounded in between; the form is right."""
    system = replace(crowded(Time.DISCRETE, lost=False), time=Time.CONTINUOUS)
    assert "there are no steps" in find_contradiction(system)
    weights, quarters = WEIGHTS[: len(acting)], truth.combine((Fraction(1, 4), Q3))
    known = {"rounding 1": Fraction(4, 4), "rounding 2": Fraction(9, 4)}
    keeps = Fraction(5, 7)
    wanted = [
        truth.inequality(move, quarters, quarters, keeps, known.get, weights)
        for move in truth.moves(system, lost=False, channels=acting, rounding=True)
    ]
    found = forms_of_steps(system, Acting(acting, weights, True), (Q3, 2), keeps, (), (4, 9))
    for (_, form), true in zip(found, wanted, strict=True):
        assert truth.is_positive_multiple(form, true)


def test_names_of_multipliers():
    """One for lost contact, and three for every force; in flows one for each force and mode."""
    assert multiplier_names(replace(bouncing_in_steps(), contact=None)) == ()
    assert multiplier_names(bouncing_in_steps()) == ("lost",)
    pulled = ("pull 1", "pull 1 lost", "lost pull 1", "pull 2", "pull 2 lost", "lost pull 2")
    assert multiplier_names(bouncing_in_steps(1)) == ("lost", *pulled)
    assert multiplier_names(bouncing(1)) == ("pull 1 free", "pull 2 free")


def test_a_map_and_a_flow_by_hand():
    A, F, G = matrix([["1/2", "1/3"], [0, "2/5"]]), ((3, 1), (1, 2)), ((5, -1), (-1, 4))
    exact, keeps = A.fractions(), Fraction(3, 7)
    moved = truth.times(truth.transpose(exact), truth.times(G, exact))
    step = map_step("", "m0", ("a", "b"), A, 7)
    form = step.form(F, G, keeps)
    assert truth.is_in_other_units(form, truth.combine((keeps, F), (-1, moved)))
    assert (step.source, step.target, step.facts, step.over) == ("a", "b", (), 1)
    half = truth.times(F, exact)
    flow = flow_step("", "m0", "a", A).form(F, F, keeps)
    wanted = truth.combine((-1, half), (-1, truth.transpose(half)), (-keeps, F))
    assert truth.is_positive_multiple(flow, wanted)


def test_a_product_that_is_zero_by_hand():
    """``-2 m (l z) (r z)``, of which nothing is left without a multiplier."""
    A, F, keeps = matrix([["1/2", "1/3"], [0, "2/5"]]), ((3, 1), (1, 2)), Fraction(3, 7)
    step = map_step("", "m0", ("a", "b"), A, 7)
    known = replace(step, products=(("p", (1, 2), (3, -1)),))
    plain = step.form(F, F, keeps)
    assert known.form(F, F, keeps) == plain
    form = known.form(F, F, keeps, {"p": 5}.__getitem__)
    more = truth.combine((1, form), (-1, plain))
    assert more == [[-5 * 6, -5 * 5], [-5 * 5, -5 * -4]]
    assert known.facts == ("p",)
    assert not Acting().rounding
