"""How contact is lost and made again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from nrs_design.proof.assumption import Assumption
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode


@dataclass(frozen=True, slots=True)
class Contact:
    """Contact that is lost and made again at any time.

    The last state is the deflection delta, the others are y. While delta is positive, the modes of
    the system are in force; while it is not, nothing pushes, and one of the free modes is.
    """

    # The motion without force, each of shape (n, n), with any switching among them. In its last
    # column, what the deflection does to the other states, there are zeros; in its last row, what
    # the motion does to the deflection.
    free: tuple[Mode, ...]
    # Shape (1, n). For an environment that could pull: forces ``q x`` at the corners of its ranges.
    # While delta is positive and a force within these ranges is not, there is no force, and one of
    # the free modes is in force. Empty for springs, whose force has the sign of the deflection.
    pulls: tuple[RationalMatrix, ...] = ()
    # Stability must be shown through any loss of contact; otherwise a proof may take for granted
    # that contact is kept, and its claim says so.
    required: bool = False
    # What is taken for granted by what covers the loss of contact, and by nothing else.
    loss: Assumption | None = None


@dataclass(frozen=True, slots=True)
class Flights:
    """Free motion among the modes of a system, to which contact is lost whatever the deflection.

    That is more than happens: the environment pushes in contact only, and where it would pull there
    is free motion. What holds for all signals holds for those; what grows must keep to them.
    """

    # Modes in which the environment acts: there, the last state, the deflection, is positive.
    touching: tuple[str, ...]
    # Modes without it: there, the deflection is not positive, or every force would pull. Modes that
    # are named nowhere are the same in contact and free.
    flying: tuple[str, ...]
    pulls: tuple[RationalMatrix, ...] = ()  # Shape (1, n). As of `Contact`.

    def among(self, names: Iterable[str]) -> Flights:
        """Return the restriction to some of the modes."""
        left = frozenset(names)
        touching, flying = (
            tuple(name for name in part if name in left) for part in (self.touching, self.flying)
        )
        return Flights(touching, flying, self.pulls)
