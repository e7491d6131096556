"""The sentence of a graph: its signals, its norm, and what it covers."""

from dataclasses import replace
from fractions import Fraction

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence.graph import Node
from nrs_design.proof.evidence.sentence import free_sentence, ruled_sentence
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from tests.proof.graphs import common_polynomial, common_quadratic, one_form
from tests.proof.rows import made
from tests.proof.systems import bouncing, bouncing_in_steps, bouncing_in_turns, family, matrix
from tests.tables import by_rows

HALF = Fraction(1, 2)


def test_one_form_for_all_modes():
    pair = family([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])
    evidence = common_quadratic(((1, 0), (0, 1)), 0, HALF)
    assert evidence.claim(pair) == (
        "Every solution of x' = A x, switching arbitrarily among the 2 modes, satisfies "
        "|x(t)| <= exp(-alpha t) |x(0)| with alpha = 0.5 1/s, in the norm |x| = sqrt(x' Q x)."
    )
    assert "among its one mode," in evidence.claim(replace(pair, modes=pair.modes[:1]))
    sixth = common_polynomial(3, ((1,),), 0, (((0,),),), HALF)
    said = "where |x|^6 is a positive definite form of degree 6 in x."
    assert sixth.claim(family([[-1]])).endswith(said)


def test_lost_contact_is_said_with_its_modes_and_its_rate_in_seconds():
    system = bouncing_in_steps()
    evidence = one_form(
        system, ((40, 20), (20, 60)), 0, Fraction(99, 100), crossings=(16,), lost=True
    )
    assert evidence.claim(system) == (
        "Every solution, with contact lost and made again at any time and switching "
        "arbitrarily among 2 modes in contact and 1 mode of free motion, satisfies "
        "|w(t)| <= rho^t |w(0)| with rho = 0.99, where w holds the states other than the "
        "deflection, and the deflection where it is positive, and |w| = sqrt(w' Q w). Where free "
        "motion ends is not claimed. A step takes 0.1 s, so that is exp(-alpha t) with "
        "alpha = 0.1 1/s."
    )
    free = (*system.contact.free, Mode("g", matrix([[-1, 0], [1, 0]])))
    two = replace(system, modes=system.modes[:1], contact=Contact(free))
    assert "among 1 mode in contact and 2 modes of free motion" in evidence.claim(two)
    flowing = free_sentence(bouncing(), HALF, 1, 1, lost=True, once=True)
    assert flowing.startswith("Every solution, with contact lost")
    each = free_sentence(system, HALF, 1, 3, lost=True, once=True)
    assert "|w| is the largest of all sqrt(w' Q w) there" in each


def test_each_form_of_a_norm_is_named():
    """A claim is true for the forms that a certificate holds, and not for one of them alone."""
    system, rate = bouncing_in_steps(), Fraction(99, 100)
    one = one_form(system, ((40, 20), (20, 60)), 0, rate, crossings=(16,), lost=True)
    other = replace(one, nodes=(one.nodes[0], Node(one.nodes[1].place, ((30,),))))
    assert other.find_fault(system) is None
    assert "|w| = sqrt(w' Q w) with the Q of contact or of free motion." in other.claim(system)
    turns = bouncing_in_turns()
    said = free_sentence(turns, HALF, 1, 1, lost=True, once=True, alike=False)
    assert "with the Q of the step of its round and of contact or of free motion." in said
    fourth = free_sentence(turns, HALF, 2, 1, lost=False, once=True)
    assert "a positive definite form of degree 4 in x, that of the step of its round." in fourth
    several = free_sentence(system, HALF, 2, 3, lost=False, once=True)
    assert "|x|^4 is the largest of some positive definite forms of degree 4 in x." in several


def test_a_constant_in_front_is_said():
    system = family([["1/2"]], [["1/2"]], time=Time.DISCRETE)
    said = free_sentence(system, HALF, 1, 2, lost=False, once=False)
    assert "|x(t)| <= c rho^t |x(0)|" in said
    assert said.endswith("and with some constant c that is the same for all signals.")


@by_rows("rules", "name", "words")
def test_words_for_the_signals(rules, name, words):
    time = Time(name)
    system = family([[-1]], [[-1]], time=time, switching=made(Switching, rules))
    law = "x' = A x" if time is Time.CONTINUOUS else "x+ = A x"
    bound = "exp(-alpha t)" if time is Time.CONTINUOUS else "rho^t"
    said = ruled_sentence(system, HALF)
    assert f"Every solution of {law} under the declared switching ({words})" in said
    assert f"satisfies |x(t)| <= c {bound} |x(0)|" in said
