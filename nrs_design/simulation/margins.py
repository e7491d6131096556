"""How fast a Lyapunov function decreases in every mode, in floating point: for figures only."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from nrs_design.certificates.evidence import CommonPolynomial, ParameterQuadratic
from nrs_design.certificates.evidence.common_polynomial import lifted_decrease, lifted_factor
from nrs_design.certificates.exact import add
from nrs_design.simulation.norms import (
    Array,
    diagonal_exponents,
    function_at,
    modes_at,
    scaled_form,
)
from nrs_design.switched.system import SwitchedSystem, Time


def mode_rates(system: SwitchedSystem, Q: Array) -> Array:
    """Return how fast ``sqrt(x' Q x)`` decays at least in every mode by itself.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    Q : ndarray, shape (n, n)
        Symmetric and positive definite.

    Returns
    -------
    ndarray, shape (m,)
        Continuous time: the largest alpha with ``A'Q + QA + 2 alpha Q <= 0``, in 1/s; negative
        where the norm can grow. Discrete time: the smallest rho with ``A'QA <= rho^2 Q``.
    """
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    largest = np.linalg.eigvalsh(inverse @ np.array(drift(system, Q)) @ inverse.T)[:, -1]
    if system.time is Time.DISCRETE:
        return np.asarray(np.sqrt(np.maximum(largest, 0.0)))
    return np.asarray(-largest / 2)


def polynomial_rates(system: SwitchedSystem, evidence: CommonPolynomial) -> Array:
    """Return the rate that the certificate's own numbers would prove for every mode alone.

    Returns
    -------
    ndarray, shape (m,)
        Decay rates in 1/s, or contractions per step, of ``V^(1/2d)``.
    """
    exponents = diagonal_exponents(evidence.Q)
    inverse = np.linalg.inv(np.linalg.cholesky(scaled_form(evidence.Q, exponents)))
    d, rate = evidence.degree, float(evidence.rate)
    slack = []
    for mode, N in zip(system.modes, evidence.vanishing, strict=True):
        form = add(lifted_decrease(mode, d, evidence.Q, evidence.rate, system.time), N)
        factor = lifted_factor(mode, d, evidence.rate, system.time)
        relative = inverse @ scaled_form(form, exponents, factor) @ inverse.T
        slack.append(float(np.linalg.eigvalsh(relative)[0]))
    if system.time is Time.CONTINUOUS:
        return rate + np.array(slack) / (2 * d)
    return np.asarray(np.maximum(rate ** (2 * d) - np.array(slack), 0.0) ** (1 / (2 * d)))


def parameter_rates(
    system: SwitchedSystem, evidence: ParameterQuadratic, values: Array
) -> tuple[list[str], Array]:
    """Return how fast the norm of Q(p) decays in every mode, over the parameter p.

    Parameters
    ----------
    system : SwitchedSystem
        With the two ends of the parameter.
    evidence : ParameterQuadratic
        Q at both ends.
    values : ndarray, shape (k,)
        From 0 (low end) to 1 (high end).

    Returns
    -------
    list of str, ndarray of shape (k, m)
        Names of the modes, and decay rates in 1/s.
    """
    names = [mode.name for mode in modes_at(system, Fraction(0)).modes]
    rates = [
        mode_rates(modes_at(system, Fraction(float(p))), function_at(evidence, float(p)))
        for p in values
    ]
    return names, np.array(rates)


def drift(system: SwitchedSystem, Q: Array) -> list[Array]:
    """Return ``A'Q + QA`` (discrete time: ``A'QA``) of every mode."""
    matrices = [np.array(mode.A.floats()) for mode in system.modes]
    if system.time is Time.DISCRETE:
        return [A.T @ Q @ A for A in matrices]
    return [A.T @ Q + Q @ A for A in matrices]
