"""Search for one quadratic function per mode under a dwell time, a transition graph and resets."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.evidence import ModeQuadratic
from nrs_design.certificates.search.balance import balance, scale
from nrs_design.certificates.search.decay import bisect_position
from nrs_design.certificates.search.lmi import decreases, time_unit
from nrs_design.certificates.search.rounding import round_rate
from nrs_design.certificates.search.sdp import maximize_margin, pack, symmetric_basis
from nrs_design.switched.system import SwitchedSystem, Time

Array = NDArray[np.float64]

BITS = (6, 8, 10, 14, 20, 28, 40, 50)
BACK_OFFS = (0.999, 0.99, 0.9, 0.5, 0.1, 1e-3)


def find_mode_quadratic(system: SwitchedSystem, limit: float) -> ModeQuadratic | None:
    """Search for the functions with the largest rate, round them, and check.

    Parameters
    ----------
    system : SwitchedSystem
        Exact modes with their switching.
    limit : float
        Rate of the slowest mode.

    Returns
    -------
    ModeQuadratic or None
        None if no rounding of any candidate passes.
    """
    problem = _Problem(system)
    if problem.solve(problem.rate_at(0.0, limit)) is None:
        return None
    best = bisect_position(lambda s: problem.solve(problem.rate_at(s, limit)) is not None)
    for back_off in BACK_OFFS:
        rate = problem.rate_at(best * back_off, limit)
        functions = problem.solve(rate)
        if functions is not None and (evidence := problem.round(functions, rate)):
            return evidence
    return None


class _Problem:
    """The semidefinite program, in balanced coordinates, for any rate."""

    def __init__(self, system: SwitchedSystem) -> None:
        self.system = system
        names = {mode.name: k for k, mode in enumerate(system.modes)}
        matrices = [np.array(mode.A.floats()) for mode in system.modes]
        if system.is_uniform:
            exponents = balance(np.array(matrices))
            self.exponents = [exponents] * len(matrices)
        else:
            self.exponents = [balance(A[None]) for A in matrices]
        self.matrices = [
            scale(A[None], d)[0] for A, d in zip(matrices, self.exponents, strict=True)
        ]
        self.switches = [
            (names[a.name], names[b.name], self._reset(a.name, b.name))
            for a, b in system.transitions()
        ]

    def _reset(self, source: str, target: str) -> Array:
        """Return the reset map in balanced coordinates."""
        modes = {mode.name: k for k, mode in enumerate(self.system.modes)}
        i, j = modes[source], modes[target]
        reset = self.system.reset_map(self.system.modes[i], self.system.modes[j])
        G = np.eye(len(self.matrices[i])) if reset is None else np.array(reset.floats())
        return np.asarray(np.ldexp(G, self.exponents[i][None, :] - self.exponents[j][:, None]))

    def rate_at(self, position: float, limit: float) -> float:
        """Return the rate between mere stability (0) and the slowest mode's (1)."""
        if self.system.time is Time.CONTINUOUS:
            return position * limit
        return 1 - position * (1 - limit)

    def solve(self, rate: float) -> list[Array] | None:
        """Maximize the margin for a rate; None if it is not positive."""
        system, sizes = self.system, [len(A) for A in self.matrices]
        starts = np.concatenate([[0], np.cumsum([n * (n + 1) // 2 for n in sizes])])
        variables = int(starts[-1]) + 1
        rows, offsets, cones = [], [], []
        strict_switches = self._steps() > 0
        flows = [self._flow(A, rate) for A in self.matrices]

        def add_cone(
            n: int, parts: list[tuple[int, Array]], margin: float, constant: float
        ) -> None:
            block = np.zeros((n * (n + 1) // 2, variables))
            for k, images in parts:
                block[:, starts[k] : starts[k + 1]] -= pack(images).T
            block[:, -1] = margin * pack(np.eye(n))
            rows.append(block)
            offsets.append(constant * pack(np.eye(n)))
            cones.append(n)

        unit = min(time_unit(A, system.time) for A in self.matrices)
        scaled_rate = float(np.ldexp(rate, unit))
        for k, (A, n) in enumerate(zip(self.matrices, sizes, strict=True)):
            basis = symmetric_basis(n)
            add_cone(n, [(k, -basis)], 0.0, 1.0)
            add_cone(n, [(k, basis)], 1.0, 0.0)
            add_cone(
                n, [(k, decreases(np.ldexp(A, unit), basis, system.time, scaled_rate))], 1.0, 0.0
            )
        for i, j, G in self.switches:
            jump = G @ flows[i] if strict_switches else G
            images = jump.T @ symmetric_basis(sizes[j]) @ jump
            parts = [(i, symmetric_basis(sizes[i])), (j, -images)]
            add_cone(sizes[i], parts, 1.0 if strict_switches else 0.0, 0.0)
        x = maximize_margin(np.vstack(rows), np.concatenate(offsets), cones)
        if x is None or x[-1] <= 0:
            return None
        return [
            np.tensordot(x[starts[k] : starts[k + 1]], symmetric_basis(n), axes=1)
            for k, n in enumerate(sizes)
        ]

    def _steps(self) -> float:
        dwell = float(self.system.switching.dwell_time)
        return max(dwell, 1.0) if self.system.time is Time.DISCRETE else dwell

    def _flow(self, A: Array, rate: float) -> Array:
        """Return the state transition over the dwell time, weighted by the rate."""
        from scipy.linalg import expm

        if self.system.time is Time.CONTINUOUS:
            return np.asarray(expm((A + rate * np.eye(len(A))) * self._steps()))
        return np.asarray(np.linalg.matrix_power(A / rate, int(self._steps())))

    def round(self, functions: list[Array], rate: float) -> ModeQuadratic | None:
        """Round all functions to integers over one denominator, and check."""
        claimed = round_rate(rate, self.system.time)
        if not claimed > 0 or (self.system.time is Time.DISCRETE and claimed >= 1):
            return None
        largest = max(np.abs(Q).max() for Q in functions)
        unit = int(np.frexp(largest)[1])
        for bits in BITS:
            evidence = self._integers(functions, bits, unit, claimed)
            if evidence.find_fault(self.system) is None:
                return evidence
        return None

    def _integers(
        self, functions: list[Array], bits: int, unit: int, rate: Fraction
    ) -> ModeQuadratic:
        top = max(int(d.max()) for d in self.exponents)
        rounded = []
        for mode, Q, d in zip(self.system.modes, functions, self.exponents, strict=True):
            scaled = np.ldexp((Q + Q.T) / 2, bits - unit)
            rows = tuple(
                tuple(
                    round(float(v)) << int(2 * top - di - dj) for v, dj in zip(row, d, strict=True)
                )
                for row, di in zip(scaled, d, strict=True)
            )
            rounded.append((mode.name, rows))
        return ModeQuadratic(tuple(rounded), max(0, bits + 2 * top), rate)
