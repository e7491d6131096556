"""The map of a law without rounding, and how often its terms are rounded."""

from fractions import Fraction
from itertools import chain

from nrs_design.controllers.step_analysis import rounded_terms
from nrs_design.models.linear_form import combine

ONE = Fraction(1)
FORMS = {
    "add": lambda left, right: combine((ONE, left), (ONE, right)),
    "subtract": lambda left, right: combine((ONE, left), (-ONE, right)),
    "multiply": lambda left, right: combine((left[0], right)),
    "saturate": lambda _, right: right,
}


def linear_forms(law, mode, given):
    """Return every value of a step as a linear form, without rounding or saturation."""
    held = {c.name: [c.number(mode)] for c in law.coefficients}
    found = law.read(held | given, FORMS)
    return {name: form for name, form in found.items() if name not in held}


def term_counts(law, mode=0):
    """Return how often each term of a law is rounded in a mode, by its name."""
    given = {value.name: [Fraction(0)] for value in law.values}
    terms = chain.from_iterable(rounded_terms(law, mode, given).values())
    return {term.name: term.roundings for term in terms if term.roundings}
