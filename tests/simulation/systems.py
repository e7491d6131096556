"""Builder of small systems."""

from __future__ import annotations

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import ARBITRARY, Reset
from nrs_design.proof.system import SwitchedSystem


def system(*matrices, time=Time.CONTINUOUS, switching=ARBITRARY):
    modes = tuple(Mode(f"m{i}", RationalMatrix.from_rows(A)) for i, A in enumerate(matrices))
    states = tuple(f"x{i + 1}" for i in range(max(map(len, matrices))))
    return SwitchedSystem(
        name="test", time=time, states=states, modes=modes, assumptions=(), switching=switching
    )


def reset(source, target, rows):
    return Reset(source, target, RationalMatrix.from_rows(rows))
