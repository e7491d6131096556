"""What holds for all tissue laws."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from nrs_design.certificates.catalogue import sentences
from nrs_design.errors import AssemblyError
from nrs_design.models.contact import (
    LINEAR_LAWS,
    Elastic,
    Hand,
    HuntCrossley,
    KelvinBoltzmann,
    KelvinVoigt,
    Maxwell,
)
from nrs_design.models.contact.law import AbstractLinearLaw, AbstractMemorylessLaw
from nrs_design.models.contact.motion import Motion
from nrs_design.models.linear_form import combine, coordinates
from tests.identification.support import wobble

# Thesis tables 2.4 and 2.5.
SAMPLES = (
    Elastic(0.207), KelvinVoigt(0.205, 0.341), Maxwell(1.129, 120.233), Maxwell(3.0, 0.4),
    KelvinBoltzmann(k1=0.233, k2=0.972, b=23.631), KelvinBoltzmann(k1=0.479, k2=3.303, b=0.5),
    HuntCrossley(rho=0.28, lam=15.328, phi=1.2),
)  # fmt: skip
IDS = [f"{law.name}-{i}" for i, law in enumerate(SAMPLES)]


def oracle(law, motion):
    """Integrate the law as it is printed, force state and all."""
    slopes = motion.increments / motion.steps

    def velocity(t):
        i = min(int(np.searchsorted(motion.time, t, side="right")) - 1, len(slopes) - 1)
        return slopes[max(i, 0)]

    if isinstance(law, Maxwell):
        tau, stiffness, damping = law.b / law.k, 0.0, law.b
    else:
        stiffness, damping, tau = law.eta
    force = [stiffness * motion.deflection[0]]
    for i, step in enumerate(motion.steps):
        slope, begin = slopes[i], motion.deflection[i]

        def rate(t, F, begin=begin, slope=slope):
            return (stiffness * (begin + slope * t) + damping * slope - F) / tau

        run = solve_ivp(rate, (0, step), [force[-1]], rtol=1e-11, atol=1e-13)
        force.append(run.y[0, -1])
    return np.array(force)


@pytest.mark.parametrize("law", [law for law in SAMPLES if law.relaxation_time is not None])
def test_discretization_is_exact_on_uneven_steps(law):
    motion = wobble(3)
    assert law.simulate(motion) == pytest.approx(oracle(law, motion), abs=2e-8)


@pytest.mark.parametrize("law", SAMPLES, ids=IDS)
def test_sensitivities_are_the_derivatives(law):
    motion = wobble(5)
    logs, h = np.log(law.values), 1e-5
    for i, column in enumerate(law.sensitivities(motion).T):
        step = h * (np.arange(len(logs)) == i)
        above, below = (type(law)(*np.exp(logs + s)).simulate(motion) for s in (step, -step))
        assert column == pytest.approx((above - below) / (2 * h), abs=1e-7 * np.abs(above).max())


@pytest.mark.parametrize("law", SAMPLES, ids=IDS)
@given(radius=st.floats(0.05, 3.0), seed=st.integers(0, 1000))
def test_torque_at_the_pivot(law, radius, seed):
    """Torque is force times lever arm, angle is deflection over lever arm."""
    motion = wobble(seed)
    turned = Motion(motion.time, motion.deflection / radius)
    torque = law.convert_to_pivot(radius).simulate(turned)
    force = law.simulate(motion)
    assert torque == pytest.approx(radius * force, abs=1e-9 * radius * np.abs(force).max())


POINT = Fraction(5)
LINEAR = [law for law in SAMPLES if law.name in LINEAR_LAWS]


def printed_impedance(law, s):
    """``F/v`` by the law as the thesis prints it, with ``delta = v/s``."""
    if isinstance(law, Maxwell):
        return law.b / (1 + law.b / law.k * s)
    if isinstance(law, KelvinBoltzmann):
        eta1, eta2, eta3 = law.eta
        return (eta1 / s + eta2) / (1 + eta3 * s)
    return law.k / s + (law.b if isinstance(law, KelvinVoigt) else 0.0)


@pytest.mark.parametrize("law", LINEAR, ids=lambda law: law.name)
@pytest.mark.parametrize("s", [0.3, 2j, 1 + 40j])
def test_impedance_and_state_space_are_the_printed_law(law, s):
    expected = printed_impedance(law, s)
    numerator, denominator = law.impedance
    assert np.polyval(numerator, s) / np.polyval(denominator, s) == pytest.approx(expected)
    velocity, *states = coordinates(1 + len(law.states))
    force, rates = law.react(velocity, states)
    C, A = np.array(force, dtype=float), np.array(rates, dtype=float)
    z = np.linalg.solve(s * np.eye(len(A)) - A[:, 1:], A[:, 0])
    assert C[1:] @ z + C[0] == pytest.approx(expected)


@dataclass(frozen=True)
class Pad(AbstractMemorylessLaw):
    """Two springs and a damper side by side: a law that nobody shipped."""

    name, kinds, front = "pad", ("stiffness", "stiffness", "damping"), "k1"

    k1: Fraction
    k2: Fraction
    c: Fraction

    def react(self, velocity, states):
        (delta,) = states
        return combine((self.k1 + self.k2, delta), (self.c, velocity)), [velocity]

    element = None


@dataclass(frozen=True)
class Unsaid(KelvinBoltzmann):
    """One that remembers, and does not say at which rates."""

    memory_rates = None


def test_a_sampled_loop_takes_a_spring_with_a_memory_and_a_damper():
    for law in LINEAR:
        if law.has_rest:
            damping = law.b if isinstance(law, KelvinVoigt) else 0
            assert law.load == (Fraction(law.stiffness), Fraction(damping))
    stretched = Maxwell(*(POINT,) * 2)
    for law in (Pad(*(POINT,) * 3), Unsaid(*(POINT,) * 3), stretched):
        with pytest.raises(AssemblyError, match="all that a sampled loop takes"):
            _ = law.load


def test_what_lags_takes_the_velocity_of_the_moment():
    lagging = {Pad(*(POINT,) * 3), KelvinVoigt(POINT, POINT), Hand(POINT, POINT, Fraction(0))}
    assert all(law.lags and not law.is_spring for law in lagging)
    springs = {Elastic(POINT), KelvinVoigt(POINT, Fraction(0)), Hand(POINT, *(Fraction(0),) * 2)}
    assert all(law.is_spring and not law.lags for law in springs)
    # One that remembers is no spring, and follows from the deflections alone.
    assert not LINEAR[-1].lags
    assert not LINEAR[-1].is_spring


@pytest.mark.parametrize("law", LINEAR, ids=lambda law: law.name)
def test_growing_stiffness(law):
    """Kelvin-Voigt holds its damping; the others grow in proportion, their ratios held."""
    stiff = 3 * law.stiffness
    larger = (
        KelvinVoigt(stiff, law.b) if isinstance(law, KelvinVoigt) else law.convert_to_pivot(3**0.5)
    )
    assert law.replace_stiffness(Fraction(stiff)).values == pytest.approx(larger.values)


@pytest.mark.parametrize("law", LINEAR, ids=lambda law: law.name)
def test_exact_parameters_stay_exact(law):
    third = type(law)(*(Fraction(1, 3) for _ in law.values))
    velocity, *states = coordinates(1 + len(law.states))
    force, _ = third.react(velocity, states)
    assert all(entry.denominator in (1, 3) for entry in force)
    assert third.convert_to_pivot(Fraction(1, 2)).exact == (Fraction(1, 12),) * len(law.values)
    assert third.texts() == tuple(
        f"{name} = 0.333333 {unit}"
        for name, unit in zip(law.parameters(), law.units(rotational=True), strict=True)
    )


@pytest.mark.parametrize("law", LINEAR, ids=lambda law: law.name)
def test_what_remembers_says_what_is_kept(law):
    alone = sentences(law.assumptions("nose", is_only=True))
    assert bool(alone) == law.has_memory
    assert all("nose" in text for text in alone)


def test_a_memory_is_spoken_of_even_if_its_law_has_no_words_of_its_own():
    class Remembering(AbstractLinearLaw):
        has_memory = True
        states = ("delta [rad]", "stretch [rad]")

    kept = "nose keeps delta [rad] and stretch [rad] at a switch and when the parameters change."
    assert sentences(Remembering.assumptions("nose", is_only=True)) == (kept,)
    (_, free) = sentences(Remembering.assumptions("nose", is_only=False))
    assert "nose is free of force" in free
