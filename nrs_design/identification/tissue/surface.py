"""Where the surface of the tissue is while nothing touches it.

A tissue that relaxes is lost before the probe is back where it was met: its surface creeps back
without force, exponentially in time for every linear law with one relaxation. Loss and next touch
are two points of that curve, so that it needs no parameter of the law.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nrs_design.identification.numeric import Array, Flags
from nrs_design.identification.tissue.contact import Touch


def surface(
    time: Array, position: Array, touches: Sequence[Touch], least: float
) -> tuple[Array, Flags]:
    """Return the deflection of the tissue, touched or not, and the samples in contact.

    Positions are in m (rad) from the contact; below the least deflection it counts as come back.
    """
    deflection, touching = np.zeros(len(time)), np.zeros(len(time), bool)
    # The first touch meets a tissue at rest: so deep it is before noise lets see its force.
    rest = max(float(position[touches[0].met]), 0.0) + least if touches else 0.0
    lost, since = 0.0, 0
    for touch in touches:
        met, left = float(position[touch.met]), float(position[touch.lost - 1])
        late = lost > 0 and met > rest
        # Whether a tissue that was lost has quite come back, only its force tells.
        begin = touch.met if lost > 0 else touch.first
        rows = slice(begin, touch.lost if left > rest else touch.end)
        deflection[rows], touching[rows] = position[rows], True
        if lost > 0:
            gap = slice(since, rows.start)
            part = (time[gap] - time[since - 1]) / (time[rows.start] - time[since - 1])
            deflection[gap] = lost * ((min(met, lost) if late else least) / lost) ** part
        lost, since = left if left > rest else 0.0, rows.stop
    # What comes after the last touch acts on nothing; a jump would be a velocity.
    deflection[since:] = lost
    return np.maximum(deflection, 0.0), touching
