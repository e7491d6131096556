"""One mode that is not stable by itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
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
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.noun import dataclass
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class UnstableMode(AbstractEvidence):
    """Staying in one mode, which is not Hurwitz (discrete time: not Schur), is admissible.

    It is not where the mode has a longest dwell time: such a mode may be unstable.

    Parameters
    ----------
    mode : str
        Its name.
    eigenvalue : str
        Its worst eigenvalue, to six digits, for the reader.
    """

    kind: ClassVar[str] = "unstable-mode"
    allows_unequal_modes: ClassVar[bool] = True

    mode: str
    eigenvalue: str

    @property
    def shows(self) -> Shows:
        """Instability."""
        return Shows.INSTABILITY

    @property
    def names_unstable_mode(self) -> bool:
        """True: that is what it shows."""
        return True

    def fits(self, switching: Switching) -> bool:
        """Tell whether no rule forces a signal to leave the mode."""
        return switching.stay(self.mode).longest is None

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that the mode exists and is not stable."""
        named = [mode for mode in system.modes if mode.name == self.mode]
        if len(named) != 1:
            return f"there is no single mode named {self.mode}"
        (mode,) = named
        if is_spectrum_too_large(mode.A):
            return f"the numbers of mode {self.mode} are too large to check"
        return f"mode {self.mode} is stable" if is_stable(mode.A, system.time) else None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no matrix has to be positive definite."""
        yield from ()

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State that the mode is not stable, and what follows."""
        continuous = system.time is Time.CONTINUOUS
        region = "Hurwitz" if continuous else "Schur"
        law = "x' = A x" if continuous else "x+ = A x"
        return (
            f"Mode {self.mode} is not {region} (eigenvalue about {self.eigenvalue}): staying in "
            f"it is an admissible switching signal, so {law} is not uniformly exponentially stable."
        )

    def to_fields(self) -> dict[str, Any]:
        """Return the mode and its eigenvalue."""
        return {"mode": self.mode, "eigenvalue": self.eigenvalue}

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the mode's name; its eigenvalue is computed again."""
        name = read_text(fields["mode"])
        matrix = next((mode.A for mode in system.modes if mode.name == name), None)
        if matrix is None:
            raise ValueError(f"the spec has no mode {name}")
        return cls(name, worst_eigenvalue(matrix, system.time))


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
