"""D. Liberzon, "Switching in Systems and Control", Birkhauser, 2003, proposition 2.9.

Hurwitz matrices that are all upper triangular share a quadratic Lyapunov function, which may be
taken diagonal.
"""

from nrs_design.search.certify import certify
from nrs_design.search.method import Method

from .known import known, settle


def test_triangular_family_is_proved():
    assert settle("triangular").evidence.kind == "block-triangular"


def test_a_quadratic_function_shows_it_in_one_piece():
    found = certify(known("triangular").system, Method.LMI)
    assert (found.verdict, found.common_quadratic) == ("proved", "exists")
