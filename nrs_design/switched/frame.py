"""One period of the sampled loop: what it does to state, disturbances and roundings, exactly."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from nrs_design.controllers.sampled import (
    ROUNDINGS,
    ROUNDINGS_WITHOUT_INERTIA,
    SampledAdmittance,
    SampledMotion,
    rounding_share,
)
from nrs_design.models.linear_form import LinearForm, combine, coordinates

ONE = Fraction(1)
# Binary digits of how large roundings are.
SIZE_BITS = 8
KP, KD, FORCE, STEP = "Kp e", "D (e - e before)", "b F", "T (v - vm)"
# What acts on a frame from outside, in this order.
INPUTS = (
    "velocity command",
    "friction",
    "encoder error",
    "force error",
    "rounding of the reference",
    "rounding of the angle",
)


@dataclass(frozen=True, slots=True)
class Frame:
    """What all modes of a sampled loop share.

    Parameters
    ----------
    period : Fraction
        In s.
    motion : SampledMotion
        The motion controller.
    has_inertia : bool
        Whether the admittances have a velocity of their own.
    longest_delay : int
        Force samples on their way.
    time_constant : Fraction or None
        The tau of the motor in s, if it is known.
    """

    period: Fraction
    motion: SampledMotion
    has_inertia: bool
    longest_delay: int
    time_constant: Fraction | None

    @property
    def roundings(self) -> dict[str, Fraction]:
        """What the arithmetic changes of every term of the law at most, over its size."""
        counts = ROUNDINGS if self.has_inertia else ROUNDINGS_WITHOUT_INERTIA
        return {name: rounding_share(count) for name, count in counts.items()}

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        ages = (f"F {j} before [N*m]" for j in range(1, self.longest_delay + 1))
        inner = ("vm [rad/s]",) if self.has_inertia else ()
        first = ("e [rad]", "omega [rad/s]", "e before [rad]")
        return (*first, *inner, *ages, "delta [rad]")

    def rows(
        self, admittance: SampledAdmittance, delay: int, values: Mapping[str, Fraction]
    ) -> list[LinearForm]:
        """Return the map of one period, and below it how large each rounding is at most.

        The first rows lead from the states, the `INPUTS` and the `roundings` to the next states;
        of a rounding, the size is at most that of its row below.

        Parameters
        ----------
        admittance : SampledAdmittance
            Of the controller in force.
        delay : int
            Age of its force sample.
        values : mapping
            The gain ``Km``, ``E = exp(-T/tau)``, and ``s = tau (1 - E)`` unless tau is known; in
            contact the stiffness ``k`` and the damping ``b`` that the force sample shows.
        """
        Km, E, tau = values["Km"], values["E"], self.time_constant
        s = values["s"] if tau is None else tau * (1 - E)
        k, b = values.get("k", Fraction(0)), values.get("b", Fraction(0))
        size, shares = len(self.states), self.roundings
        unit = coordinates(size + len(INPUTS) + len(shares))
        error, omega, before, delta = unit[0], unit[1], unit[2], unit[size - 1]
        command, friction, encoder, sensor, reference, angle = unit[size : size + len(INPUTS)]
        rounded = dict(zip(shares, unit[size + len(INPUTS) :], strict=True))
        samples = unit[size - 1 - self.longest_delay : size - 1]
        read = combine((ONE, error), (-ONE, encoder), (-ONE, angle))
        seen = combine((ONE, read), (ONE, rounded["e"]))
        Kp, D, T = self.motion.Kp, self.motion.D, admittance.T
        drive = combine((Kp + D, seen), (-D, before), (ONE, friction))
        drive = combine((ONE, drive), (ONE, rounded[KP]), (ONE, rounded[KD]))
        moved = combine((s, omega), (Km * (self.period - s), drive))
        ages = [combine((k, delta), (b, omega), (ONE, sensor)), *samples]
        pushed, kept = combine((admittance.b, ages[delay])), []
        velocity = combine((ONE, pushed), (ONE, rounded[FORCE]))
        if admittance.a is None:
            exact = pushed
        else:
            inner = combine((admittance.a, unit[3]))
            kept = [combine((ONE, inner), (ONE, velocity), (ONE, rounded["a vm"]))]
            velocity = exact = unit[3]
        first = combine((ONE, error), (T, command), (-T, velocity), (ONE, rounded[STEP]))
        # Of a sum of two sizes, the part that is of second order counts with another term.
        second = shares[KP] * Kp * (1 + shares["e"]) + shares[KD] * D * shares["e"]
        static = ONE if kept else 1 + shares[STEP]
        sizes = {
            "e": (shares["e"], read),
            KP: (second, read),
            KD: (shares[KD] * D, combine((ONE, read), (-ONE, before))),
            "a vm": (shares.get("a vm", ONE) * (admittance.a or 0), unit[3]),
            FORCE: (shares[FORCE] * static * admittance.b, ages[delay]),
            STEP: (shares[STEP] * T, combine((ONE, command), (-ONE, exact))),
        }
        return [
            combine((ONE, first), (ONE, reference), (-ONE, moved)),
            combine((E, omega), (Km * (1 - E), drive)),
            seen,
            *kept,
            *ages[: self.longest_delay],
            combine((ONE, delta), (ONE, moved)),
            *(combine((_short(factor), form)) for factor, form in (sizes[name] for name in shares)),
        ]


def _short(size: Fraction) -> Fraction:
    """Round a size up to a few binary digits, so that the numbers of a certificate stay short."""
    unit = Fraction(2) ** (size.numerator.bit_length() - size.denominator.bit_length() - SIZE_BITS)
    return ceil(size / unit) * unit
