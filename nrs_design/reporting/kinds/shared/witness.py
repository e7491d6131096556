"""What the simulated witnesses of instability have in common."""

from __future__ import annotations

import numpy as np

from nrs_design.reporting.document import Block, Section
from nrs_design.simulation.norms import Array
from nrs_design.simulation.switched import TimeResponse

_TITLE = "Simulated witness"


def witness(*blocks: Block) -> Section:
    """Return the section of a run that shows instability."""
    return Section(_TITLE, blocks)


def euclidean_norms(response: TimeResponse) -> Array:
    """Return the norm of the states along a run, relative to the start."""
    values = np.linalg.norm(response.state, axis=1)
    return np.asarray(values / values[0])
