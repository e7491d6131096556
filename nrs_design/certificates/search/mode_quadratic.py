"""Search for one quadratic function per mode under a dwell time, a transition graph and resets."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.evidence import ModeQuadratic
from nrs_design.certificates.evidence.unstable_mode import is_stable
from nrs_design.certificates.search.balance import balance, scale
from nrs_design.certificates.search.decay import bisect_position
from nrs_design.certificates.search.lmi import decreases, time_unit
from nrs_design.certificates.search.rounding import round_rate
from nrs_design.certificates.search.sdp import maximize_margin, pack, symmetric_basis
from nrs_design.switched.system import Edge, Mode, Stay, SwitchedSystem, Time

Array = NDArray[np.float64]

BITS = (6, 8, 10, 14, 20, 28, 40, 50)
BACK_OFFS = (0.999, 0.99, 0.9, 0.5, 0.1, 1e-3)
# Numbers of steps that are each shown for a mode that is stable, too.
FEW_STAYS = 64
# Times at which the functions are sought for a mode that must be left, and pieces that are shown.
SAMPLES = 17
PIECES = (32, 256, 1024)
# Enclosures take time: fewer attempts.
ENCLOSED_BITS = (12, 28)
ENCLOSED_BACK_OFFS = (0.9, 0.5, 0.1)


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
    for back_off in ENCLOSED_BACK_OFFS if problem.encloses_stays else BACK_OFFS:
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
            self._switch(names[edge.source.name], names[edge.target.name], edge)
            for edge in system.edges()
        ]
        self.stays = list(system.stays().values())
        self.leaving = [
            self._is_left(mode, stay) for mode, stay in zip(system.modes, self.stays, strict=True)
        ]

    @property
    def encloses_stays(self) -> bool:
        """Whether the checker will enclose all the times that a mode may stay active."""
        return any(self.leaving) and self.system.time is Time.CONTINUOUS

    def _switch(self, i: int, j: int, edge: Edge) -> tuple[int, int, Array]:
        """Return an edge with its reset map in balanced coordinates."""
        G = np.eye(len(self.matrices[i])) if edge.map is None else np.array(edge.map.floats())
        return i, j, np.ldexp(G, self.exponents[i][None, :] - self.exponents[j][:, None])

    def _is_left(self, mode: Mode, stay: Stay) -> bool:
        """Tell whether to show every stay, which asks for less than a decrease, but for longer."""
        if stay.longest is None:
            return False
        few = stay.longest - stay.shortest < FEW_STAYS and self.system.time is Time.DISCRETE
        return few or not is_stable(mode.A, self.system.time)

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
        flows = [self._flows(k, rate) for k in range(len(self.matrices))]

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
            if not self.leaving[k]:
                images = decreases(np.ldexp(A, unit), basis, system.time, scaled_rate)
                add_cone(n, [(k, images)], 1.0, 0.0)
        for i, j, G in self.switches:
            at_once = self.stays[i].shortest == 0 and not self.leaving[i]
            for flow in flows[i]:
                jump = G @ flow
                images = jump.T @ symmetric_basis(sizes[j]) @ jump
                parts = [(i, symmetric_basis(sizes[i])), (j, -images)]
                add_cone(sizes[i], parts, 0.0 if at_once else 1.0, 0.0)
        x = maximize_margin(np.vstack(rows), np.concatenate(offsets), cones)
        if x is None or x[-1] <= 0:
            return None
        return [
            np.tensordot(x[starts[k] : starts[k + 1]], symmetric_basis(n), axes=1)
            for k, n in enumerate(sizes)
        ]

    def _flows(self, mode: int, rate: float) -> list[Array]:
        """Return the state transitions over the stays that count, weighted by the rate."""
        from scipy.linalg import expm

        A, stay = self.matrices[mode], self.stays[mode]
        first, last = float(stay.shortest), float(stay.shortest)
        if self.leaving[mode] and stay.longest is not None:
            last = float(stay.longest)
        if self.system.time is Time.CONTINUOUS:
            times = np.linspace(first, last, SAMPLES if last > first else 1)
            return [np.asarray(expm((A + rate * np.eye(len(A))) * time)) for time in times]
        steps = range(int(first), int(last) + 1)
        return [np.asarray(np.linalg.matrix_power(A / rate, k)) for k in steps]

    def round(self, functions: list[Array], rate: float) -> ModeQuadratic | None:
        """Round all functions to integers over one denominator, and check."""
        claimed = round_rate(rate, self.system.time)
        if not claimed > 0 or (self.system.time is Time.DISCRETE and claimed >= 1):
            return None
        largest = max(np.abs(Q).max() for Q in functions)
        unit = int(np.frexp(largest)[1])
        if self.encloses_stays:
            attempts = list(product(PIECES, ENCLOSED_BITS))
        else:
            attempts = [(1, bits) for bits in BITS]
        for pieces, bits in attempts:
            evidence = replace(self._integers(functions, bits, unit, claimed), pieces=pieces)
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
        names = (mode.name for mode in self.system.modes)
        leaving = tuple(name for name, left in zip(names, self.leaving, strict=True) if left)
        return ModeQuadratic(tuple(rounded), max(0, bits + 2 * top), rate, leaving)
