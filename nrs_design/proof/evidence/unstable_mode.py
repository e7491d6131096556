"""One mode that is not stable by itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from nrs_design.proof.enclosure import eigenvalues
from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import read_text
from nrs_design.proof.exact import (
    MAX_SPECTRUM_WORK,
    IntegerMatrix,
    TooLargeError,
    bit_length,
    is_hurwitz,
    is_schur,
    spectrum_work,
)
from nrs_design.proof.matrix import RationalMatrix, leading
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class UnstableMode(AbstractEvidence):
    """Staying in one mode, which is not Hurwitz (discrete time: not Schur), is admissible.

    It is not where the mode has a longest dwell time: such a mode may be unstable. Where contact
    must be covered as it is lost, the mode may be one of free motion, without the deflection: far
    enough from the surface, such a motion goes on for as long as is wanted.
    """

    kind: ClassVar[str] = "unstable-mode"
    allows_unequal_modes: ClassVar[bool] = True

    mode: str  # Its name
    eigenvalue: str  # Its worst eigenvalue, to six digits, for the reader

    @property
    def shows(self) -> Shows:
        """Instability."""
        return Shows.INSTABILITY

    @property
    def names_unstable_mode(self) -> bool:
        """True: that is what it shows."""
        return True

    @property
    def used(self) -> frozenset[str]:
        """The mode."""
        return frozenset((self.mode,))

    def covers_loss(self, system: SwitchedSystem) -> bool:
        """Tell whether the mode is one of free motion, or the same in contact and free."""
        return _is_free(system, self.mode) or AbstractEvidence.covers_loss(self, system)

    def fits(self, switching: Switching) -> bool:
        """Tell whether no rule forces a signal to leave the mode."""
        return switching.stay(self.mode).longest is None

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that the mode exists and is not stable."""
        if (A := matrix_of(system, self.mode)) is None:
            return f"there is no single mode named {self.mode}"
        if is_spectrum_too_large(A):
            return f"the numbers of mode {self.mode} are too large to check"
        return f"mode {self.mode} is stable" if is_stable(A, system.time) else None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no matrix has to be positive definite."""
        yield from ()

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State that the mode is not stable, and what follows."""
        continuous = system.time is Time.CONTINUOUS
        region = "Hurwitz" if continuous else "Schur"
        law = "x' = A x" if continuous else "x+ = A x"
        free = _is_free(system, self.mode)
        beside = ", the deflection aside," if free else ""
        again = ", for as long as is wanted if it begins far from the surface" if free else ""
        return (
            f"Mode {self.mode}{beside} is not {region} (eigenvalue about {self.eigenvalue}): "
            f"staying in it is an admissible switching signal{again}, so {law} is not uniformly "
            "exponentially stable."
        )

    def to_fields(self) -> dict[str, Any]:
        """Return the mode and its eigenvalue."""
        return {"mode": self.mode, "eigenvalue": self.eigenvalue}

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the mode's name; its eigenvalue is computed again."""
        name = read_text(fields["mode"])
        matrix = matrix_of(system, name)
        if matrix is None:
            raise ValueError(f"the spec has no mode {name}")
        return cls(name, worst_eigenvalue(matrix, system.time))


def free_motions(system: SwitchedSystem) -> tuple[Mode, ...]:
    """TRUSTED: return the modes of free motion without the deflection, where they must be covered.

    Parameters
    ----------
    system : SwitchedSystem
        With the modes; where they take turns, none of them is in force for long.
    """
    contact = system.contact
    if contact is None or not contact.required or system.clock is not None:
        return ()
    return tuple(
        Mode(mode.name, RationalMatrix(tuple(leading(mode.A.numerators)), mode.A.denominator))
        for mode in contact.free
    )


def decides(system: SwitchedSystem, mode: str) -> bool:
    """Tell whether a mode that is not stable refutes the system, and not in kept contact alone.

    Parameters
    ----------
    system : SwitchedSystem
        With the mode.
    mode : str
        Its name.
    """
    return UnstableMode(mode, "").shown(system) is Shows.INSTABILITY


def matrix_of(system: SwitchedSystem, name: str) -> RationalMatrix | None:
    """TRUSTED: return the matrix of a mode, of free motion without the deflection; None if unclear.

    Parameters
    ----------
    system : SwitchedSystem
        With the mode.
    name : str
        Of the mode.
    """
    named = [mode.A for mode in (*system.modes, *free_motions(system)) if mode.name == name]
    return named[0] if len(named) == 1 else None


def _is_free(system: SwitchedSystem, name: str) -> bool:
    return any(mode.name == name for mode in free_motions(system))


def is_spectrum_too_large(A: RationalMatrix) -> bool:
    """Tell whether `is_stable` would take more than some seconds."""
    return _work(A) > MAX_SPECTRUM_WORK


def affordable(modes: Iterable[Mode]) -> Iterator[tuple[Mode, bool]]:
    """Yield modes, each with whether it can be decided within some seconds for all of them."""
    spent = 0
    for mode in modes:
        work = _work(mode.A)
        fits = spent + work <= MAX_SPECTRUM_WORK
        spent += work * fits
        yield mode, fits


def _work(A: RationalMatrix) -> int:
    return spectrum_work(
        len(A.numerators), max(bit_length(A.numerators), A.denominator.bit_length())
    )


def is_stable(A: RationalMatrix, time: Time) -> bool:
    """TRUSTED: decide whether a matrix is Hurwitz (continuous time) or Schur (discrete time).

    Raises
    ------
    TooLargeError
        If that would take more than some seconds.
    """
    _check_size(A)
    if time is Time.CONTINUOUS:
        return is_hurwitz(A.numerators)
    return is_schur(A.numerators, A.denominator)


def worst_eigenvalue(A: RationalMatrix, time: Time) -> str:
    """Return the eigenvalue nearest to or farthest beyond the stability limit, to six digits.

    Raises
    ------
    TooLargeError
        If that would take more than some seconds.
    """
    _check_size(A)
    centers = [complex(ball) for ball in eigenvalues(A)]
    z = max(centers, key=lambda z: z.real if time is Time.CONTINUOUS else abs(z))
    if abs(z.imag) <= 1e-14 * abs(z):
        return f"{z.real:.6g}"
    return f"{z.real:.6g} +- {abs(z.imag):.6g}j"


def _check_size(A: RationalMatrix) -> None:
    if is_spectrum_too_large(A):
        raise TooLargeError(
            "the numbers of a mode are too large to decide exactly whether it is stable"
        )
