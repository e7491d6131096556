"""What a probe feels that the tissue pushes and never pulls: simulated for tests.

The surface of the tissue follows the probe while the force is positive; then it comes back by
itself, without force, until the probe meets it again.
"""

from __future__ import annotations

import math

import numpy as np

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.models.contact import (
    AbstractContactLaw,
    Elastic,
    HuntCrossley,
    KelvinBoltzmann,
    KelvinVoigt,
    Maxwell,
)
from nrs_design.models.contact.motion import Motion
from tests.identification.support import source
from tests.identification.synthetic import Array


def push(law: AbstractContactLaw, probe: Motion) -> Array:
    """Return the force on a probe; its position is counted from the tissue at rest."""
    if isinstance(law, Maxwell):
        return _relaxing(0.0, law.k, law.b, probe)
    if isinstance(law, KelvinBoltzmann):
        return _relaxing(*law.values, probe)
    return _memoryless(law, probe)


def _relaxing(k1: float, k2: float, b: float, probe: Motion) -> Array:
    time, x = probe.time, probe.deflection
    force, d = np.zeros(len(x)), 0.0
    rate, gain = (k1 + k2) / b, k2 / b
    for i in range(len(x)):
        if i:
            h = time[i] - time[i - 1]
            if force[i - 1] > 0:
                slope, a = (x[i] - x[i - 1]) / h, math.exp(-rate * h)
                d = a * d + gain * (
                    x[i - 1] * (1 - a) / rate + slope * (h / rate - (1 - a) / rate**2)
                )
            else:
                d *= math.exp(-k1 / b * h)
        force[i] = max(k2 * (x[i] - d), 0.0)
    return force


def _memoryless(law: AbstractContactLaw, probe: Motion) -> Array:
    x = probe.deflection
    law_force = law.simulate(Motion(probe.time, x))
    force, surface = np.zeros(len(x)), 0.0
    for i in range(len(x)):
        h = probe.time[i] - probe.time[i - 1] if i else 0.0
        if isinstance(law, KelvinVoigt):
            surface *= math.exp(-law.k / law.b * h)
        elif isinstance(law, HuntCrossley):
            surface = max(surface - law.rho / law.lam * h, 0.0)
        else:
            assert isinstance(law, Elastic)
            surface = 0.0
        if x[i] > surface and law_force[i] > 0:
            force[i], surface = law_force[i], x[i]
    return force


def robot_record(
    law: AbstractContactLaw,
    motion: Motion,
    noise: float,
    seed: int,
    *,
    air: float = 0.4,
    zero: float = 0.0,
    tare: float = 0.0,
    drift: float = 0.0,
    side: int = 1,
) -> TissueRecord:
    """Return a record in the coordinates of a robot: zero in m, tare in N, drift in N/s.

    The travel in air is a multiple of the depth; on side -1 the tissue is at smaller positions.
    """
    depth = float(motion.deflection.max())
    position = (1 + air) * motion.deflection - air * depth
    force = push(law, Motion(motion.time, position))
    force += noise * np.random.default_rng(seed).standard_normal(len(position))
    force += side * (tare + drift * motion.time)
    shown = Motion(motion.time, side * position + zero)
    return TissueRecord(source(f"robot-{seed}"), shown, side * force, False)
