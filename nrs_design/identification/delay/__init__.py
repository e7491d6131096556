"""The delay of a running loop, from what was sent and what came of it."""

from nrs_design.identification.delay.fit import DelayFit
from nrs_design.identification.delay.identify import DelayIdentification, identify_delay

__all__ = ["DelayFit", "DelayIdentification", "identify_delay"]
