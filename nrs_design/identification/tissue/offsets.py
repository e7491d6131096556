"""Offsets of a record: position of contact, force in air and drift.

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

ZERO, TARE, CONTACT, DRIFT = "zero", "tare", "contact", "drift"
# Names, and units of a linear motion and of a rotation.
OFFSET_WORDS: Mapping[str, str] = MappingProxyType(
    {ZERO: "position of contact", TARE: "force in air", DRIFT: "drift of the force"}
)
OFFSET_UNITS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {ZERO: ("m", "rad"), TARE: ("N", "N m"), DRIFT: ("N/s", "N m/s")}
)


@dataclass(frozen=True, slots=True)
class Offset:
    """An offset with its 95 % interval."""

    name: str  # ``zero`` (position of contact), ``tare`` (force in air) or ``drift`` (of the tare)
    estimate: Estimate  # In m, N or N/s (rad, N m, N m/s)
    fitted: bool  # Whether the value is fitted
    provided: str = ""  # Condition or origin of the value; empty for none

    def text(self, *, rotational: bool) -> str:
        """Return name, value and unit in words."""
        value = str(self.estimate) if self.fitted else f"{self.estimate.value:.5g}"
        rest = f" ({self.provided})" if self.provided else "" if self.fitted else " (given)"
        return f"{OFFSET_WORDS[self.name]} {value} {OFFSET_UNITS[self.name][rotational]}{rest}"


def offset_names(kind: type[AbstractContactLaw], trial: Trial) -> tuple[str, ...]:
    """Return the offsets that add to the force in proportion."""
    settings, names = trial.preparation, []
    keeps_force = issubclass(kind, AbstractLinearLaw) and kind.has_rest
    if settings.tare is None:
        names.append(TARE)
    if keeps_force and settings.zero is None and (trial.contact is not None or not names):
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
    moved = [] if shift is None else [(ZERO, shift)]
    constants = [*moved, *zip(names, values.tolist(), strict=True)]
    fitted = {name: (at, value) for at, (name, value) in enumerate(constants, len(law.values))}
    quantile, settings = student_quantile(known.degrees), trial.preparation

    def signed(name: str, reference: float = 0.0) -> Offset:
        at, value = fitted[name]
        half = quantile * math.sqrt(max(float(known.covariance[at, at]), 0.0))
        middle = reference + trial.side * value
        return Offset(name, Estimate(middle, middle - half, middle + half), True)

    offsets, constant = [], CONTACT if CONTACT in fitted else TARE
    # Only the sum of both shows.
    assumed = False
    if settings.zero is not None:
        offsets.append(Offset(ZERO, Estimate(settings.zero, settings.zero, settings.zero), False))
    elif shift is not None:
        offsets.append(signed(ZERO, trial.reference))
    elif constant in fitted and _static(law)[0]:
        assumed = trial.contact is None and settings.tare is None
        balanced = _balanced(law, trial, known, *fitted[constant])
        offsets.append(Offset(ZERO, balanced, True, "if the tare is 0" if assumed else ""))
    if settings.tare is not None:
        offsets.append(Offset(TARE, Estimate(settings.tare, settings.tare, settings.tare), False))
    elif assumed:
        offsets.append(Offset(TARE, Estimate(0.0, 0.0, 0.0), False, "taken as zero"))
    else:
        offsets.append(signed(TARE))
    return (*offsets, signed(DRIFT)) if DRIFT in fitted else tuple(offsets)


def _balanced(
    law: AbstractContactLaw, trial: Trial, known: Uncertainty, at: int, value: float
) -> Estimate:
    """Return the position where a constant force is balanced by the stiffness at rest.

    The interval is Fieller's (1954): all quotients that the data do not reject. Where the stiffness
    may be 0, it has no end.
    """
    stiffness, slopes = _static(law)
    gradients = np.zeros((2, len(known.covariance)))
    gradients[0, : len(slopes)] = slopes
    gradients[1, at] = 1.0
    covariance = gradients @ known.covariance @ gradients.T
    # A push by the constant is a deflection to the other side.
    side = -trial.side
    ends = quotients((stiffness, value), covariance, student_quantile(known.degrees))
    low, high = sorted(side * end for end in ends)
    middle = side * value / stiffness
    return Estimate(*(trial.reference + part for part in (middle, low, high)))


def _static(law: AbstractContactLaw) -> tuple[float, Array]:
    """Return the stiffness at rest, and its derivatives by the logarithms of the parameters."""
    rest = Motion(np.array([0.0, 1.0]), np.ones(2))
    return float(law.simulate(rest)[0]), law.sensitivities(rest)[0]
