"""Offsets of a record: where contact begins, and what the force sensor shows in air.

For a law that is linear in its deflection, both are constants that add to the force: one in air and
one in contact. Where a record has no air, only their sum shows, and one of them must be given, or
taken as zero, to tell the other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from nrs_design.identification.numeric import Array
from nrs_design.identification.statistics import Estimate, Uncertainty, quotients, student_quantile
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import AbstractContactLaw, AbstractLinearLaw, Motion

TARE, CONTACT, DRIFT = "tare", "contact", "drift"
# In words, and with the units of a linear motion and of a rotation.
OFFSET_WORDS: Mapping[str, str] = MappingProxyType(
    {"zero": "position of contact", "tare": "force in air", "drift": "drift of the force"}
)
OFFSET_UNITS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {"zero": ("m", "rad"), "tare": ("N", "N m"), "drift": ("N/s", "N m/s")}
)


@dataclass(frozen=True, slots=True)
class Offset:
    """An offset with its 95 % interval."""

    name: str  # ``zero`` (position of contact), ``tare`` (force in air) or ``drift`` (of the tare)
    estimate: Estimate  # In m, N or N/s (rad, N m, N m/s)
    fitted: bool  # Whether it was fitted; else it is as given
    provided: str = ""  # What it rests on, empty for the record alone


def fits_zero(kind: type[AbstractContactLaw], trial: Trial) -> bool:
    """Tell whether the position of contact is a parameter that enters nonlinearly."""
    return not issubclass(kind, AbstractLinearLaw) and trial.preparation.zero is None


def offset_names(kind: type[AbstractContactLaw], trial: Trial) -> tuple[str, ...]:
    """Return the offsets that add to the force in proportion."""
    wanted, names = trial.preparation, []
    keeps_force = issubclass(kind, AbstractLinearLaw) and kind.has_rest
    if wanted.tare is None:
        names.append(TARE)
    if keeps_force and wanted.zero is None and (trial.found is not None or not names):
        names.append(CONTACT)
    return (*names, DRIFT) if trial.drift else tuple(names)


def offset_columns(names: Sequence[str], trial: Trial) -> Array:
    """Return the force that a unit of each offset adds to all samples, shape (n, m)."""
    columns = {
        TARE: np.ones(len(trial.used)),
        CONTACT: trial.touching.astype(float),
        DRIFT: trial.motion.time - trial.motion.time[0],
    }
    return np.column_stack([np.empty((len(trial.used), 0)), *(columns[name] for name in names)])


def measured_force(trial: Trial) -> Array:
    """Return the force of the used samples, less a tare that is given."""
    tare = trial.preparation.tare
    return trial.measured if tare is None else trial.measured - trial.side * tare


def estimate_offsets(
    law: AbstractContactLaw,
    trial: Trial,
    names: Sequence[str],
    values: Array,
    shift: float | None,
    known: Uncertainty,
) -> tuple[Offset, ...]:
    """Turn fitted constants into the position of contact, the tare and its drift.

    `known` is of p logarithms, the move of the contact if there is one, and the m constants.
    """
    first = len(law.values) + (shift is not None)
    at = {name: first + i for i, name in enumerate(names)}
    value = dict(zip(names, values.tolist(), strict=True))
    reader = _Reader(trial, known)
    is_rest = isinstance(law, AbstractLinearLaw) and _static(law)[0] > 0
    offsets = [_zero(law, trial, at, value, shift, reader)]
    wanted = trial.preparation
    if wanted.tare is not None:
        offsets.append(Offset("tare", Estimate(wanted.tare, wanted.tare, wanted.tare), False))
    elif trial.found is None and wanted.zero is None and is_rest:
        offsets.append(Offset("tare", Estimate(0.0, 0.0, 0.0), False, "taken as zero"))
    else:
        offsets.append(Offset("tare", reader.signed(at[TARE], value[TARE]), True))
    if DRIFT in at:
        offsets.append(Offset("drift", reader.signed(at[DRIFT], value[DRIFT]), True))
    return tuple(offset for offset in offsets if offset is not None)


@dataclass(frozen=True, slots=True, eq=False)
class _Reader:
    """Turns fitted values into intervals in the signs of the record."""

    trial: Trial
    known: Uncertainty

    def signed(self, at: int, value: float, reference: float = 0.0) -> Estimate:
        variance = float(self.known.covariance[at, at])
        half = student_quantile(self.known.degrees) * math.sqrt(max(variance, 0.0))
        middle = reference + self.trial.side * value
        return Estimate(middle, middle - half, middle + half)

    def divided(self, law: AbstractContactLaw, at: int, value: float) -> Estimate:
        """Return the position where a constant force is balanced by the stiffness at rest.

        The interval is Fieller's (1954): all quotients that the data do not reject. Where the
        stiffness may be 0, it has no end.
        """
        stiffness, slopes = _static(law)
        gradients = np.zeros((2, len(self.known.covariance)))
        gradients[0, : len(slopes)] = slopes
        gradients[1, at] = 1.0
        covariance = gradients @ self.known.covariance @ gradients.T
        quantile = student_quantile(self.known.degrees)
        # A push by the constant is a deflection to the other side.
        side = -self.trial.side
        ends = (side * end for end in quotients((stiffness, value), covariance, quantile))
        low, high = sorted(ends)
        middle = side * value / stiffness
        return Estimate(*(self.trial.reference + part for part in (middle, low, high)))


def _zero(
    law: AbstractContactLaw,
    trial: Trial,
    at: dict[str, int],
    value: dict[str, float],
    shift: float | None,
    reader: _Reader,
) -> Offset | None:
    wanted = trial.preparation
    if wanted.zero is not None:
        return Offset("zero", Estimate(wanted.zero, wanted.zero, wanted.zero), False)
    if shift is not None:
        return Offset("zero", reader.signed(len(law.values), shift, trial.reference), True)
    name = CONTACT if CONTACT in at else TARE
    if not _static(law)[0] or name not in at:
        # A law without rest does not tell.
        return None
    provided = "" if trial.found is not None or wanted.tare is not None else "if the tare is 0"
    return Offset("zero", reader.divided(law, at[name], value[name]), True, provided)


def _static(law: AbstractContactLaw) -> tuple[float, Array]:
    """Return the stiffness at rest, and its derivatives by the logarithms of the parameters."""
    rest = Motion(np.array([0.0, 1.0]), np.ones(2))
    return float(law.simulate(rest)[0]), law.sensitivities(rest)[0]
