"""Whether the air in a record tells how the tare of a force sensor moves.

Where it does, the drift is fitted, however small: a drift that is left out because no test sees it
would still move the tare, by more than the interval of a tare that is taken to rest (Leeb and
Poetscher 2005, on inference after a choice of the model).
"""

from __future__ import annotations

import numpy as np

from nrs_design.identification.numeric import Array, Flags

_FEWEST = 30
# The air must be spread over this part of the record for a slope to be one of the record.
_SPREAD = 0.3
# Samples of a contact in between.
_BETWEEN = 20


def shows_drift(time: Array, air: Flags) -> bool:
    """Tell whether there is air before and after a contact, far enough apart.

    Within one stretch of air, a tissue that is soft at first would pass for a drift.
    """
    rows = np.flatnonzero(air)
    if len(rows) < _FEWEST or np.ptp(time[rows]) < _SPREAD * np.ptp(time):
        return False
    return bool(np.diff(rows).max() >= _BETWEEN)
