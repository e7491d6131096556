"""Chapters 4, 6 and 7 about one axis: actuator, motion loop, impedance, force, hands-on control."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from math import degrees, exp, log, pi, sqrt
from statistics import fmean

from nrs_design.controllers.laws import Admittance
from nrs_design.design.force_loop import (
    Approach,
    force_loop_response,
    peak_force,
    steady_force_error,
)
from nrs_design.design.impedance_optimum import ImpedanceLoop, ImpedanceProblem, optimize_impedance
from nrs_design.design.passivity import passive_band
from nrs_design.design.root_locus import PdDesign, design_pd, motion_loop_response
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import Elastic
from nrs_design.spec.controllers import Offset
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Recomputed, Result
from nrs_design.thesis.motor import MOTOR, armature_resistance, speed_torque_gradient, voltage_gain


def actuator() -> Iterable[Result]:
    """Recompute the actuator's constants from the frequency response and table 4.1."""
    resistance = armature_resistance(thesis.ACTUATOR, MOTOR)
    return (
        1 / thesis.BREAK_FREQUENCY,
        10 ** (thesis.GAIN_IN_DECIBEL / 20),
        thesis.MOTOR_INERTIA + thesis.GEARHEAD_INERTIA,
        voltage_gain(thesis.ACTUATOR, MOTOR),
        resistance,
        speed_torque_gradient(resistance, MOTOR),
    )


def _pd(time_constant: float) -> PdDesign:
    gain = float(thesis.ACTUATOR.gain)
    return design_pd(gain, time_constant, thesis.DAMPING_RATIO, thesis.SETTLING_TIME)


def root_locus() -> Iterator[Result]:
    """Recompute the design by angle and magnitude condition, then what it really gives."""
    # The thesis places the zero with the pole of 4.26b, the gain with the rounded 0.0351 s of 4.29.
    unrounded, design = (_pd(1 / thesis.BREAK_FREQUENCY), _pd(float(thesis.ACTUATOR.time_constant)))
    wn, zeta = design.natural_frequency, thesis.DAMPING_RATIO
    yield from (wn, wn**2, 2 * zeta * wn)
    yield unrounded.wanted_poles[0]
    facts = f"{design.zero:.4f}", f"{degrees(unrounded.zero_angle):.4f}"
    yield Recomputed(degrees(design.zero_angle), facts=facts)
    yield from (unrounded.zero, design.derivative_gain)
    yield float(thesis.DERIVATIVE_GAIN * thesis.ZERO)
    loop = thesis.EXACT_LOOP
    response = motion_loop_response(loop)
    yield from (response.poles[0], response.damping_ratio)
    second_order = exp(-pi * zeta / sqrt(1 - zeta**2))
    yield Recomputed(100 * response.overshoot, facts=(f"{100 * second_order:.1f}",))
    yield (*loop.numerator, *loop.denominator)


LOOPS = (thesis.PRINTED_LOOP, thesis.EXACT_LOOP)


def impedance() -> Iterator[Result]:
    """Recompute what is desired, the four optima with either G, and how stiff is too stiff."""
    desired, soft, stiff = thesis.DESIRED, float(thesis.SOFT), float(thesis.STIFF)
    yield from (desired, desired / 2, 2 * pi * thesis.BANDWIDTH_IN_HERTZ, soft, stiff)
    yield soft / 0.24**2
    # Stiffness, desired impedance and least Mt of each design.
    for design in (
        (soft, desired, 0.0),
        (soft, desired, 0.01),
        (soft, desired / 2, 0.01),
        (stiff, desired, 0.01),
    ):
        yield from (_optimum(loop, *design) for loop in LOOPS)
    # The natural logarithm in 6.4 weighs the displayed impedance ln 10 times more.
    loop, weight = thesis.EXACT_LOOP, log(10) / 2
    found = (
        *_optimum(loop, soft, desired / 2, 0.01, weight=weight),
        *_optimum(loop, stiff, desired, 0.01, weight=weight),
    )
    yield Recomputed(found, abs(found[1] - 1.04) > 0.01 and abs(found[3] - 2.11) > 0.01)
    yield from (thesis.stiffness_limit(0.01, Bt) for Bt in (1.04, 2.11, 2.15))


def _optimum(
    loop: TransferFunction, stiffness: float, desired: float, mass_bound: float, weight: float = 0.5
) -> tuple[float, float]:
    problem = ImpedanceProblem(
        loop=ImpedanceLoop(loop, Elastic(stiffness)),
        desired=desired,
        bandwidth=2 * pi * thesis.BANDWIDTH_IN_HERTZ,
        mass_bounds=(mass_bound, 1.0),
        damping_bounds=(0.1, 20.0),
        weight_displayed=weight,
    )
    optimum = optimize_impedance(problem)
    return optimum.Mt, optimum.Bt


def force_loop() -> Iterable[Result]:
    """Recompute the open loop 6.33, what Kp = 0.02 gives, and 6.3.3.3 for both X_i of 6.41."""
    stiffness, loop = float(thesis.SOFT), thesis.EXACT_LOOP
    closed = force_loop_response(loop, stiffness, float(thesis.FORCE_GAIN))
    limit = force_loop_response(loop, stiffness, 0.0)
    limit_facts = (f"{limit.damping_ratio:.4f}", f"{limit.natural_frequency:.2f}")
    peak, left = _peak_and_error("reference", 5.0)
    positions = [_peak_and_error("measured", speed) for speed in (3.0, 5.0, 8.0)]
    return (
        (*(stiffness * b for b in loop.numerator), *loop.denominator),
        Recomputed(closed.damping_ratio, facts=limit_facts),
        Recomputed(closed.natural_frequency, facts=limit_facts),
        Recomputed((peak, left), facts=(f"{10 / left:.2f}",)),
        (*(force for force, _ in positions), max(error for _, error in positions)),
    )


def _peak_and_error(offset: Offset, speed: float) -> tuple[float, float]:
    """Return the peak torque in N m and the steady error in %, arriving at a speed in deg/s."""
    approach = Approach(offset, math.radians(speed), 0.3)
    arguments = (thesis.EXACT_LOOP, float(thesis.SOFT), float(thesis.FORCE_GAIN), approach)
    peak = peak_force(*arguments)
    assert peak is not None
    return peak, 100 * steady_force_error(*arguments)


# Times in s without and with switching, by experiment of 6.3.2.3.
TIMES = ((0.75, 0.61), (0.53, 0.41), (0.09, 0.07), (0.16, 0.13))
# Displayed impedances of 6.3.1.2, three of phi and three of psi, N m s/rad.
DISPLAYED = (2.1372, 2.0997, 2.1766, 2.0494, 2.0883, 2.1131)


def experiments() -> Iterable[Result]:
    """List the measurements, and recompute what the thesis says of them."""
    gains = tuple(100 * (1 - fast / slow) for slow, fast in TIMES)
    return (
        tuple(100 * (impedance_shown / thesis.DESIRED - 1) for impedance_shown in DISPLAYED),
        (degrees(0.0873), degrees(0.0524)),
        gains,
        fmean(gains),
    )


# Mt in kg m^2 and Bt in kg m^2/s of each experiment.
ADMITTANCES = ((1, 4), (2, 4), (3, 4), (1, 8), (2, 8), (3, 8))


def passivity() -> Iterable[Result]:
    """Compute the poles of G Y, the hand that destabilizes the robot, and where it is passive."""
    motion = motion_loop_response(thesis.EXACT_LOOP).poles
    laws = (Admittance(Fraction(Mt), Fraction(Bt)) for Mt, Bt in ADMITTANCES)
    bands = [passive_band(thesis.AXIS, law, {}) for law in laws]
    passive = tuple(float(band.passive or 0) / (2 * math.pi) for band in bands)
    return (
        Recomputed(
            tuple(-Bt / Mt for Mt, Bt in ADMITTANCES), all(pole.real < 0 for pole in motion)
        ),
        tuple(thesis.stiffness_limit(Mt, Bt) for Mt, Bt in ADMITTANCES),
        Recomputed(passive, all(band.broken is not None for band in bands)),
    )
