"""Modes lifted to monomials of one degree, in floating point, and the forms that vanish there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import factorial, prod

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.lift import derivative_lift, monomials, power_lift
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Reset
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import scale_states
from nrs_design.search.lmi import time_unit
from nrs_design.search.sdp import (
    pack,
    unpack,
)

Array = NDArray[np.float64]
Exponents = NDArray[np.int64]
Pair = tuple[int, int]


@dataclass(frozen=True)
class Lift:
    """A family lifted to degree d, in floating point and in well-conditioned coordinates."""

    variables: int  # The number of states n
    degree: int  # The d
    matrices: Array  # Shape (m, K, K). Lifted modes in the coordinates ``2^e z(x)``.
    # Shape (p, K, K). Basis of the symmetric N with ``z' N z = 0`` for all x, in the same
    # coordinates.
    vanishing: Array
    exponents: Exponents  # Shape (K,). The e.
    unit: int  # The modes are those in a unit of time of two to this power (discrete time: zero)


def lift_family(system: SwitchedSystem, exponents: Exponents, degree: int) -> Lift:
    """Lift the modes exactly, then scale by powers of two.

    Monomials are weighted by powers of two near ``sqrt(multinomial)``: nearly an orthonormal
    basis in the rotation-invariant inner product of forms, so that degree keeps helping.

    Parameters
    ----------
    system : SwitchedSystem
        Exact modes.
    exponents : ndarray of int, shape (n,)
        Balancing exponents of the states.
    degree : int
        Half the degree of the function.
    """
    basis = monomials(system.order, degree)
    scaling = monomial_weights(system.order, degree)
    scaling -= np.array(basis, dtype=np.int64) @ exponents
    lifted = np.array([_lift_mode(mode.A, degree, system.time).floats() for mode in system.modes])
    matrices = np.ldexp(lifted, scaling[:, None] - scaling[None, :])
    # The unit of the modes themselves: lifted entries, and margins with them, grow with degree.
    given = np.array([mode.A.floats() for mode in system.modes])
    unit = time_unit(scale_states(given, exponents), system.time)
    forms = _differences(system.order, degree, scaling)
    return Lift(system.order, degree, np.ldexp(matrices, unit), forms, scaling, unit)


def products(variables: int, degree: int) -> list[list[Pair]]:
    """Group the pairs of monomials by their product; diagonal pairs first in their group."""
    basis = monomials(variables, degree)
    groups: dict[tuple[int, ...], list[Pair]] = {}
    for i, a in enumerate(basis):
        for j in range(i, len(basis)):
            key = tuple(p + q for p, q in zip(a, basis[j], strict=True))
            groups.setdefault(key, []).append((i, j))
    return [sorted(group, key=lambda pair: pair[0] != pair[1]) for group in groups.values()]


def monomial_weights(variables: int, degree: int) -> Exponents:
    """Return the logarithms of powers of two near ``sqrt(multinomial)``."""
    counts = [factorial(degree) / prod(map(factorial, a)) for a in monomials(variables, degree)]
    return np.asarray(np.rint(np.log2(counts) / 2).astype(np.int64))


def _differences(variables: int, degree: int, scaling: Exponents) -> Array:
    """Return a basis of the forms that vanish identically, shape (p, K, K)."""
    pairs = [group for group in products(variables, degree) if len(group) > 1]
    forms = [_difference(group[0], other, scaling) for group in pairs for other in group[1:]]
    return np.array(forms).reshape(-1, len(scaling), len(scaling))


def vanishing_basis(variables: int, degree: int, scaling: Exponents) -> Array:
    """Return an orthonormal basis of the forms that vanish, in the coordinates ``2^e z(x)``.

    Parameters
    ----------
    variables : int
        Length of x.
    degree : int
        Of the monomials z.
    scaling : ndarray of int
        The exponents e.
    """
    return orthonormal(_differences(variables, degree, scaling))


def orthonormal(forms: Array) -> Array:
    """Return an orthonormal basis of the span of symmetric matrices, shape (p, K, K)."""
    if not len(forms):
        return forms
    return unpack(np.linalg.qr(pack(forms).T)[0].T, forms.shape[-1])


def vanishing_in(lift: Lift, coordinates: Array) -> Array:
    """Return the vanishing form of each mode, shape (m, K, K), from the unknowns of a program.

    Parameters
    ----------
    lift : Lift
        The modes.
    coordinates : ndarray
        Of all forms, one mode after the other.
    """
    weights = coordinates.reshape(len(lift.matrices), len(lift.vanishing))
    basis = orthonormal(lift.vanishing)
    return np.asarray(np.tensordot(weights, basis, axes=1))


def lift_system(system: SwitchedSystem, degree: int) -> SwitchedSystem:
    """Return the system of the monomials of a degree, in discrete time.

    Parameters
    ----------
    system : SwitchedSystem
        Discrete time; its switches fit its modes.
    degree : int
        The d.
    """

    def lift(A: RationalMatrix) -> RationalMatrix:
        return _lift_mode(A, degree, Time.DISCRETE)

    modes = tuple(Mode(mode.name, lift(mode.A)) for mode in system.modes)
    resets = system.switching.resets
    resets = tuple(Reset(item.source, item.target, lift(item.map)) for item in resets)
    states = tuple(f"z{k + 1}" for k in range(max(mode.A.shape[0] for mode in modes)))
    return system.with_modes(modes, states, replace(system.switching, resets=resets))


def _lift_mode(A: RationalMatrix, degree: int, time: Time) -> RationalMatrix:
    if time is Time.CONTINUOUS:
        rows, denominator = derivative_lift(A.numerators, degree), A.denominator
    else:
        rows, denominator = power_lift(A.numerators, degree), A.denominator**degree
    return RationalMatrix(tuple(map(tuple, rows)), denominator)


def _difference(one: Pair, other: Pair, scaling: Exponents) -> Array:
    """Return the form ``z_i z_j - z_k z_l`` of two pairs with the same product, scaled."""
    form = np.zeros((len(scaling), len(scaling)))
    for (i, j), sign in ((one, 1.0), (other, -1.0)):
        form[i, j] += sign / 2
        form[j, i] += sign / 2
    return np.asarray(np.ldexp(form, -scaling[:, None] - scaling[None, :]))
