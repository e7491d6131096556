"""Two modes whose switching is stable or not, by one number.

Dayawansa and Martin 1999: a = 5 has a common quadratic function, a = 6 has none and is stable,
a = 12 is not stable.
"""

from fractions import Fraction

ROTATION = [[-1, -1], [1, -1]]


def pair(a):
    return [ROTATION, [[-1, -a], [Fraction(1, a), -1]]]
