"""D. Liberzon, "Switching in Systems and Control", Birkhauser, 2003, proposition 2.9.

Hurwitz matrices that are all upper triangular share a quadratic Lyapunov function, which may be
taken diagonal.
"""

from .known import settle


def test_triangular_family_is_proved():
    settle("triangular")
