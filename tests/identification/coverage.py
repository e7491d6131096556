"""How often 95 % intervals of a tissue hold the truth: every law under every option.

``python -m tests.identification.coverage`` prints the table of `coverage.md`, in about ten minutes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import lfilter

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.identification.tissue.trial import Preparation, prepare
from nrs_design.models.contact import (
    AbstractContactLaw,
    AbstractLinearLaw,
    Elastic,
    HuntCrossley,
    KelvinVoigt,
    Maxwell,
    Motion,
)
from tests.identification import synthetic
from tests.identification.support import quick, record, slow
from tests.identification.unilateral import robot_record

SEEDS = 200
ZERO, TARE, DRIFT = 0.3, -0.04, 0.001


@dataclass(frozen=True)
class Tissue:
    """A law, a motion that determines its parameters, the noise of the force, the first seed."""

    law: AbstractContactLaw
    motion: Callable[[int], Motion]
    noise: float
    first: int


TISSUES: Mapping[str, Tissue] = {
    "elastic": Tissue(Elastic(768.17), quick, 0.0969, 0),
    "kelvin-voigt": Tissue(KelvinVoigt(0.574, 0.957), slow, 0.0114, 100_000),
    "maxwell": Tissue(Maxwell(1.129, 20.0), slow, 0.0135, 200_000),
    "kelvin-boltzmann": Tissue(synthetic.CONCHA, slow, 0.0085, 400_000),
    "hunt-crossley": Tissue(HuntCrossley(0.28, 15.328, 1.2), slow, 0.0096, 500_000),
}

# A record in air does not tell its stiffness at rest from 0, which is a doubt.
UNDETERMINED: Mapping[str, Tissue] = {"nose": Tissue(synthetic.NOSE, slow, 0.0165, 600_000)}


def touching(tissue: Tissue, seed: int) -> TissueRecord:
    data = record(tissue.law, tissue.motion(seed), tissue.noise, seed)
    return _moved(data)


def coarse(tissue: Tissue, seed: int) -> TissueRecord:
    motion = tissue.motion(seed)
    step = synthetic.COUNT if tissue.motion is quick else 1e-4
    moved = motion.deflection + step * np.random.default_rng([seed, 2]).uniform()
    data = record(tissue.law, Motion(motion.time, moved), tissue.noise, seed, step)
    return _moved(data)


def colored(tissue: Tissue, seed: int) -> TissueRecord:
    data = record(tissue.law, tissue.motion(seed), 0.0, seed)
    white = np.random.default_rng(seed).standard_normal(len(data.force))
    error = lfilter([np.sqrt(1 - 0.81)], [1, -0.9], white)
    return _moved(replace(data, force=data.force + tissue.noise * error))


def airy(tissue: Tissue, seed: int, drift: float = 0.0) -> TissueRecord:
    """Return a record with air before, between and after touches of a tissue that only pushes."""
    return robot_record(
        tissue.law, tissue.motion(seed), tissue.noise, seed, zero=ZERO, tare=TARE, drift=drift
    )


def drifting(tissue: Tissue, seed: int) -> TissueRecord:
    return airy(tissue, seed, DRIFT)


def _moved(data: TissueRecord) -> TissueRecord:
    motion = Motion(data.motion.time, data.motion.deflection + ZERO)
    return replace(data, motion=motion, force=data.force + TARE)


AUTO, GIVEN = Preparation(), Preparation(contact="given")


@dataclass(frozen=True)
class Option:
    make: Callable[[Tissue, int], TissueRecord]
    preparation: Preparation = AUTO

    def truth(self, name: str, tissue: Tissue) -> float:
        """Return what an offset truly is; without air, only both together are known."""
        known = {"zero": ZERO, "tare": TARE, "drift": DRIFT if self.make is drifting else 0.0}
        law = tissue.law
        given = self.preparation.tare is not None or self.make in (airy, drifting)
        if name == "zero" and isinstance(law, AbstractLinearLaw) and not given:
            still = Motion(np.array([0.0, 1.0]), np.ones(2))
            return ZERO - TARE / float(law.simulate(still)[0])
        return known[name]


OPTIONS: Mapping[str, Option] = {
    "in contact, both given": Option(touching, replace(GIVEN, zero=ZERO, tare=TARE)),
    "in contact, `zero`": Option(touching, replace(GIVEN, zero=ZERO)),
    "in contact, `tare`": Option(touching, replace(GIVEN, tare=TARE)),
    "in contact, both fitted": Option(touching),
    "`start`, `end`": Option(touching, Preparation(start=3.0, end=60.0)),
    "coarse position": Option(coarse, GIVEN),
    "noise with a memory": Option(colored, GIVEN),
    "air, both fitted": Option(airy),
    "air, `zero`": Option(airy, Preparation(zero=ZERO)),
    "air, `tare`": Option(airy, Preparation(tare=TARE)),
    "air, `drift=none`": Option(airy, Preparation(drift="none")),
    "air, tare that drifts": Option(drifting),
}


def rates(tissue: str, option: str, seeds: int = SEEDS) -> dict[str, float]:
    """Return how often each interval holds the truth, in per cent.

    Every cell has seeds of its own, so that no two share their luck.
    """
    chosen, asked = {**TISSUES, **UNDETERMINED}[tissue], OPTIONS[option]
    index = list(OPTIONS).index(option)
    # An option is gone behind the fifth; the others keep their seeds.
    first = chosen.first + 5_000 * (index + (index > 4))
    hits: dict[str, list[bool]] = {}
    for seed in range(first, first + seeds):
        for name, held in _held(chosen, asked, seed):
            hits.setdefault(name, []).append(held)
    return {name: 100 * float(np.mean(row)) for name, row in hits.items()}


def _held(tissue: Tissue, option: Option, seed: int) -> Iterator[tuple[str, bool]]:
    law = tissue.law
    fit = fit_record(type(law), prepare(option.make(tissue, seed), option.preparation))
    for name, estimate, value in zip(law.parameters(), fit.estimates, law.values, strict=True):
        yield name, estimate.covers(value)
    for offset in fit.offsets:
        if offset.fitted:
            yield offset.name, offset.estimate.covers(option.truth(offset.name, tissue))


def main() -> None:
    for option in OPTIONS:
        for tissue in TISSUES:
            found = rates(tissue, option)
            text = ", ".join(f"{name} {rate:.1f}" for name, rate in found.items())
            print(f"{option} | {tissue} | {text}", flush=True)


if __name__ == "__main__":
    main()
