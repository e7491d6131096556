from dataclasses import replace
from fractions import Fraction

from nrs_design.proof.steps import Stays
from nrs_design.proof.switching import Stay
from nrs_design.reporting.evidence import page_of
from tests.proof.systems import genuine

SYSTEM, EVIDENCE = genuine("mode-polynomial")
PAGE = page_of(SYSTEM, EVIDENCE)


def test_the_size_is_that_of_the_certificate():
    (section,) = PAGE.sections()
    (text,) = section.blocks
    assert f"holds {len(SYSTEM.modes)} functions, one for each mode: V = z' Q z" in text.text
    assert PAGE.name == "polynomial of degree 4 of each mode"


def test_it_rests_on_the_declared_rules():
    """And on the times of single modes, which are whole steps: there are no exponentials."""
    assert "The list of allowed switches is part of the claim as well." in PAGE.meaning
    assert PAGE.limits[-1] == "Switches that the spec does not list."
    assert "Leaving a mode before its own dwell time is over." in PAGE.limits
    assert PAGE.meaning[-1].endswith("; a second library agreed.")
    assert not any("exponentials" in text for text in PAGE.meaning)


def test_modes_that_must_be_left_are_named_as_for_quadratic_functions():
    left = SYSTEM.modes[0].name
    stays = ((left, Stay(Fraction(1), Fraction(2))),)
    system = replace(SYSTEM, switching=replace(SYSTEM.switching, stays=stays))
    own = replace(EVIDENCE, stays=Stays((left,)))
    page, quadratic = page_of(system, own), page_of(system, replace(own, degree=1))
    assert f"Staying longer than declared in {left}." in page.limits
    assert page.limits == quadratic.limits
    assert page.meaning[:-1] == quadratic.meaning[:-1]


def test_the_run_is_drawn_beside_the_slope_of_its_bound():
    run = PAGE.run().blocks[0]
    labels = [line.get_label() for line in run.figure.axes[0].lines]
    assert "slope of the proved bound, rho^t" in labels
    assert "up to one constant factor" in run.caption


def test_stays_that_are_counted_are_said_where_the_bound_is():
    page = page_of(*genuine("periodic-quadratic, stays"))
    assert page.name == "quadratic function of each sample of a stay"
    assert any("whatever switches happen, as the rules allow" in text for text in page.meaning)
    assert any("decreases faster than the claim" in text for text in page.meaning)
    assert "Switches that come before a dwell time has passed." in page.limits
    assert "every switching signal, as the rules allow" in page.run().blocks[0].caption


def test_a_round_has_no_rules_besides():
    page = page_of(*genuine("periodic-quadratic, kept"))
    assert page.name == "quadratic function of each step of a round"
    assert not any("as the rules allow" in text for text in page.meaning)
