"""Records made in memory."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord, TissueRecord
from nrs_design.identification.tables.table import Source
from nrs_design.models.contact import AbstractContactLaw
from nrs_design.models.contact.motion import Motion
from tests.identification import synthetic
from tests.identification.synthetic import Array
from tests.support import ROOT


def write_csv(path: Path, header: str, *columns: Array) -> Path:
    np.savetxt(path, np.column_stack(columns), "%.9g", ",", header=header, comments="")
    return path


def source(name: str) -> Source:
    return Source(Path(f"{name}.csv"), hashlib.sha256(name.encode()).hexdigest(), True)


def record(
    law: AbstractContactLaw,
    motion: Motion,
    noise: float = 0.0,
    seed: int = 0,
    resolution: float = 0.0,
    *,
    rotational: bool = False,
) -> TissueRecord:
    measured, force = synthetic.tissue_record(law, motion, noise, seed, resolution)
    return TissueRecord(source(f"record-{seed}"), measured, force, rotational)


def slow(seed: int = 0, depth: float = 0.35) -> Motion:
    """Presses of 20 s over 80 s, in rad."""
    return synthetic.pressing(80.0, 20.0, depth, 20.0, seed)


def quick(seed: int = 0) -> Motion:
    """Presses of 5 s over 15 s, up to 7 mm."""
    return synthetic.pressing(15.0, 100.0, 0.007, 5.0, seed)


def sinusoids(
    seed: int, frequencies: Sequence[float] = synthetic.FREQUENCIES
) -> list[SignalRecord]:
    return [
        SignalRecord(source(f"{hertz:g}"), *synthetic.actuator_record(hertz, 100 * seed + i))
        for i, hertz in enumerate(frequencies)
    ]


def wobble(seed: int, count: int = 60) -> Motion:
    generator = np.random.default_rng(seed)
    time = np.concatenate([[0.0], np.cumsum(generator.uniform(0.01, 0.3, count - 1))])
    return Motion(time, np.concatenate([[0.0], np.cumsum(generator.normal(size=count - 1))]))


def holds(estimates, values):
    return [e.covers(v) for e, v in zip(estimates, values, strict=True)]


DATA = ROOT / "specs" / "data"
SOFT = sorted(DATA.glob("silicone-soft-*.csv"))
NOSE = sorted(DATA.glob("nose-*.csv"))
SINUSOIDS = sorted(DATA.glob("actuator-*hz.csv"))
