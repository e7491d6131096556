"""How often the terms of a law are rounded."""

from fractions import Fraction
from itertools import chain

from nrs_design.controllers.step_analysis import rounded_terms


def term_counts(law, mode=0):
    """Return how often each term of a law is rounded in a mode, by its name."""
    given = {value.name: [Fraction(0)] for value in law.values}
    terms = chain.from_iterable(rounded_terms(law, mode, given).values())
    return {term.name: term.roundings for term in terms if term.roundings}
