"""The impact of a robot on a region of a body: two masses and a spring, rounded to the safe side.

Two masses m_R and m_B meet at the speed v with a spring k between them and nothing else. With the
reduced mass ``mu = 1/(1/m_R + 1/m_B)`` the transferred energy is ``E = mu v^2/2 = F^2/(2 k)``, so
the largest force is ``F = v sqrt(mu k)`` (ISO/TS 15066:2016, A.3). The region is accelerated by a
half sine of height ``a = F/m_B`` that lasts ``pi sqrt(mu/k)``.

The head injury criterion is the largest ``(t2 - t1) (mean of a/g from t1 to t2)^2.5`` over all
windows. Of a half sine it is ``2 u (sin u/u)^2.5 sqrt(mu/k) (a/g)^2.5`` at ``u = 1.0528``, half of
the window in radians. Thesis 2.15 takes the window to be the whole contact, ``u = pi/2``, which is
less by a factor of 0.78, and has no g. What the criterion is, and is not: D. Gao, C. W. Wampler,
Head injury criterion, IEEE Robotics and Automation Magazine 16 (4), 2009.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

# Above the largest 2 u (sin u/u)^2.5 for u from 0 to pi/2.
HALF_SINE = Fraction("1.30265")
# Standard gravity, m/s^2: the 3rd General Conference on Weights and Measures, 1901.
GRAVITY = Fraction("9.80665")
# Binary digits of a root.
_DIGITS = 64


@dataclass(frozen=True, slots=True)
class Impact:
    """Two masses and, where more than the energy is asked for, the spring between them."""

    robot: Fraction  # Effective mass in kg
    body: Fraction  # In kg
    stiffness: Fraction | None = None  # N/m

    @property
    def reduced_mass(self) -> Fraction:
        """The mass mu of the relative motion, kg."""
        return self.robot * self.body / (self.robot + self.body)

    def energy(self, speed: Fraction) -> Fraction:
        """Return the transferred energy in J at a relative speed in m/s."""
        return self.reduced_mass * speed**2 / 2

    def force(self, speed: Fraction) -> Fraction:
        """Return a force in N that is not below the largest one."""
        return speed * above_root(self.reduced_mass * self._k, 2)

    def hic(self, speed: Fraction) -> Fraction:
        """Return a number that is not below the head injury criterion."""
        height = self.force(speed) / (self.body * GRAVITY)
        duration = above_root(self.reduced_mass / self._k, 2)
        return HALF_SINE * duration * height**2 * above_root(height, 2)

    def speed_of_energy(self, energy: Fraction) -> Fraction:
        """Return a speed in m/s that is not above the one that transfers an energy."""
        return below_root(2 * energy / self.reduced_mass, 2)

    def speed_of_force(self, force: Fraction) -> Fraction:
        """Return a speed in m/s that is not above the one that causes a force."""
        return force / self.force(Fraction(1))

    def speed_of_hic(self, limit: Fraction) -> Fraction:
        """Return the safe speed: not above the one whose criterion is a limit (thesis 2.17).

        The criterion is ``varpi v^2.5``, so the speed is ``(limit/varpi)^(1/2.5)``; the print
        leaves the exponent out.
        """
        return below_root((limit / self.hic(Fraction(1))) ** 2, 5)

    @property
    def _k(self) -> Fraction:
        assert self.stiffness is not None, "a force is that of a spring"
        return self.stiffness


def below_root(x: Fraction, degree: int) -> Fraction:
    """Return a number that is not above a root of a positive one, within some 2^-60 of it.

    Parameters
    ----------
    x : Fraction
        Positive.
    degree : int
        2 for the square root.
    """
    # Scaled by a power of two so that the whole part of the root has the digits.
    size = x.numerator.bit_length() - x.denominator.bit_length()
    shift = _DIGITS - size // degree
    return _whole_root(x * Fraction(2) ** (shift * degree), degree) / Fraction(2) ** shift


def above_root(x: Fraction, degree: int) -> Fraction:
    """Return a number that is not below a root of a positive one; the root itself if it is found.

    Parameters
    ----------
    x, degree
        As for `below_root`.
    """
    found = below_root(x, degree)
    size = x.numerator.bit_length() - x.denominator.bit_length()
    step = Fraction(2) ** (size // degree - _DIGITS)
    return found if found**degree == x else found + step


def _whole_root(x: Fraction, degree: int) -> int:
    """Return the largest integer whose power is not above a number of at least 1."""
    low, high = 0, 1 << (_DIGITS + 2)
    while high - low > 1:
        middle = (low + high) // 2
        if middle**degree <= x:
            low = middle
        else:
            high = middle
    return low
