"""The offset X_i of force control (thesis 6.41): a memory that every switch takes anew.

The command of the motion loop is ``u = r`` in position mode and ``u = X_i + Kp (Fd - F)`` in force
mode. X_i is held, so a mode has no rest point of its own: it rests wherever X_i lets it, and in
coordinates of the position it has the eigenvalue zero. What decays is the motion. With
``w = xi'`` and constant commands every mode is ``w' = A w``, with the A that it has without an
offset, and X_i is gone. At a switch xi stays and u may jump: ``w+ = w + B (u+ - u)``.

- `reference`: X_i is the command before the switch, so u stays and w too.
- `measured`: X_i is the position theta, so ``u+ = theta``. As G(0) = 1, the lead of the command is
  ``u - theta = -C Ap^-1 w``, a form of w alone. It stands last among the coordinates here: a switch
  sets it to zero, and leaves the others as they are.

Both hold where the force at a switch to force control is Fd; otherwise u+ has the term
``Kp (Fd - F)`` besides, which is an input.
"""

from __future__ import annotations

from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.models.motion_loop import Realization


def lead(motion: Realization) -> list[Fraction]:
    """Return ``u - theta`` as a linear form of ``w = xi'``: the y with ``y Ap = -C``.

    Parameters
    ----------
    motion : Realization
        Of the motion loop, from position to position.

    Raises
    ------
    AssemblyError
        If the motion loop does not rest where it is commanded to be, ``G(0) != 1``: then the lead
        depends on the position too.
    """
    last, C = motion.A[-1], motion.C
    if C[0] != -last[0] or not last[0]:
        raise AssemblyError(
            "an offset is not modelled for a motion loop that does not rest at its command: "
            "G(0) is not 1",
            remedy="use `offset: none`, or a transfer function with G(0) = 1",
            at=("motion_loop", "transfer_function"),
        )
    return [*(-c - a for c, a in zip(C[1:], last[1:], strict=True)), Fraction(1)]
