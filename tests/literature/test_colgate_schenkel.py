"""The virtual wall of Colgate and Schenkel: passive exactly if b > K T/2 + |B|.

Passivity of a class of sampled-data systems: application to haptic interfaces, Journal of Robotic
Systems 14(1), 1997, equations 13 and 22: a device with the damping b that displays the law H(z) is
passive if and only if ``b > T/2 Re{(1 - exp(-j omega T)) H}/(1 - cos omega T)`` at all frequencies;
the wall is ``H = K + B (z - 1)/(T z)``.
"""

from fractions import Fraction

import pytest

from nrs_design.design.affine_family import polynomial, real_product
from nrs_design.design.passivity import first_root
from nrs_design.loop.cut_loop import apply_bilinear

NEAR = Fraction(1, 10**9)


def is_passive(b, K, B, T):
    """Decide the condition by the first root, in ``x = tan(omega T/2)^2``.

    With ``1 - cos = 2 x/(1 + x)`` and ``(1 - 1/z) H = N/(T z^2)``, it is that ``4 b T x (1 + x)``
    is above the real part of N times the conjugate of ``T z^2``; both have a factor x.
    """
    above, below = [K * T + B, -K * T - 2 * B, B], [T, Fraction(0), Fraction(0)]
    N, D = (polynomial(*apply_bilinear(p, Fraction(2))) for p in (above, below))
    real = real_product(N, D)
    assert real[0] == 0
    P = polynomial(4 * b * T, 4 * b * T) - real.right_shift(1)
    return P[0] > 0 and P[1] > 0 and first_root(P) is None


@pytest.mark.parametrize("K", [Fraction(1000), Fraction(1)])
@pytest.mark.parametrize("B", [Fraction(0), Fraction(3), Fraction("-0.25")])
@pytest.mark.parametrize("T", [Fraction("0.001"), Fraction("0.01")])
def test_the_wall(K, B, T):
    limit = K * T / 2 + abs(B)
    assert is_passive(limit + NEAR, K, B, T)
    assert not is_passive(limit - NEAR, K, B, T)
