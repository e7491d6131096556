"""The least bound on an output under disturbances, and how it changes with the modes (untrusted).

For a fixed share of the disturbances the bound is the value of one semidefinite program; at the
best share its slope is that at the fixed one (envelope theorem). It is taken by a small change of
the modes, with the program solved again.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, log, sqrt

from numpy.linalg import LinAlgError

from nrs_design.proof.channels import Output
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.invariant_ellipsoid import BoundProgram, Frame, largest_share
from nrs_design.work import Allowance

# Shares beside one that was the best nearby.
BESIDE = (0.6, 1.0, 1.6)


@dataclass(frozen=True)
class ForceSlope:
    """The least bound that is found, and how it changes with small changes of the modes."""

    level: float  # SI units of the output
    share: float  # Of the disturbances; a guess for systems nearby
    _output: Output
    _frame: Frame  # Which stays for small changes
    _allowance: Allowance

    def change(self, system: SwitchedSystem) -> float:
        """Return by how much the logarithm of the bound of a system nearby is larger."""
        with floats_in_silence():
            program = BoundProgram.around(system, system.channels, self._output, self._frame)
            found = program.solve(self.share, self._allowance)
        if found is None:
            return 0.0
        return log(self._frame.level * sqrt(found.last) / self.level)


def force_slope(
    system: SwitchedSystem, output: Output, allowance: Allowance, share: float | None = None
) -> ForceSlope | None:
    """Find the least bound on an output under all disturbances at once, but for roundings.

    `share` was the best of a system nearby. None if no bound is found in floating point.
    """
    with floats_in_silence():
        try:
            frame = Frame.of(system, system.channels, output)
        except LinAlgError:  # A mode that grows has no norm.
            return None
        if frame is None:
            return None
        program = BoundProgram.around(system, system.channels, output, frame)
        limit = Family.of(system).limit
        top, tried = largest_share(limit, system.time), {}
        for near in (share * factor for factor in BESIDE if share is not None):
            if near < top and (found := program.solve(near, allowance)) is not None:
                tried[near] = found.last
        best = min(tried, key=lambda one: tried[one], default=None)
        if best is None:
            least, best = program.best_share(limit, system.time, allowance)
        else:
            least = tried[best]
    if not isfinite(least):
        return None
    return ForceSlope(frame.level * sqrt(least), best, output, frame, allowance)
