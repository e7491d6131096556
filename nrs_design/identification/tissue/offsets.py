"""Offsets of a record: position of contact, force in air and drift.

For a law that is linear in its deflection, both are constants that add to the force: one in air and
one in contact. Where a record has no air, only their sum shows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nrs_design.identification.numeric import Array
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import AbstractContactLaw, AbstractLinearLaw, Motion

ZERO, TARE, CONTACT, DRIFT = "zero", "tare", "contact", "drift"


def offset_names(kind: type[AbstractContactLaw], trial: Trial) -> tuple[str, ...]:
    """Return the offsets that add to the force in proportion."""
    keeps_force = issubclass(kind, AbstractLinearLaw) and kind.has_rest
    both = (TARE, CONTACT) if keeps_force and trial.contact is not None else (TARE,)
    return (*both, DRIFT) if trial.drift else both


def offset_columns(names: Sequence[str], trial: Trial) -> Array:
    """Return the force that a unit of each offset adds to all samples, shape (n, m)."""
    columns = {
        TARE: np.ones(len(trial.used)),
        CONTACT: trial.touching.astype(float),
        DRIFT: trial.motion.time - trial.motion.time[0],
    }
    return np.column_stack([columns[name] for name in names])


def place_offsets(
    law: AbstractContactLaw, trial: Trial, fitted: dict[str, float], shift: float | None
) -> dict[str, float]:
    """Turn fitted constants into the position of contact, the tare and its drift, in SI.

    Without air, the position is the one at which the tare is zero, and there is no tare. A law that
    keeps no force has no position.
    """
    places = {name: trial.side * fitted[name] for name in (TARE, DRIFT) if name in fitted}
    if shift is not None:
        return {ZERO: trial.reference + trial.side * shift, **places}
    at_rest = Motion(np.array([0.0, 1.0]), np.ones(2))
    if not (stiffness := float(law.simulate(at_rest)[0])):
        return places
    if trial.contact is None:
        del places[TARE]
    constant = fitted.get(CONTACT, fitted[TARE])
    return {ZERO: trial.reference - trial.side * constant / stiffness, **places}
