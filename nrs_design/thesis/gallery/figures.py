"""All counterparts, in the order of the thesis."""

from __future__ import annotations

from nrs_design.progress import Progress, silent
from nrs_design.thesis.gallery import (
    agility,
    force_limit,
    hands,
    impedance,
    two_contacts,
)
from nrs_design.thesis.gallery.counterpart import Counterpart

TOPICS = (
    ("figures 6.14 and 6.15", impedance.counterparts),
    ("figures 6.16 to 6.21", agility.counterparts),
    ("figures 6.22 to 6.27", force_limit.counterparts),
    ("figures 6.28 to 6.34", two_contacts.counterparts),
    ("hands on", hands.counterparts),
)


def draw_counterparts(
    progress: Progress = silent,
) -> tuple[Counterpart, ...]:
    """Simulate and draw all of them.

    Parameters
    ----------
    progress : callable
        Told which figures come next.
    """
    found: list[Counterpart] = []
    for topic, counterparts in TOPICS:
        progress(topic)
        found.extend(counterparts())
    return tuple(found)
