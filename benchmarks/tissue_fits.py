"""Five tissue laws with their offsets on ten records of 10,000 samples each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from time import process_time
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from benchmarks.measure import Comparison, Size
from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tables.table import Source
from nrs_design.identification.tissue.output_error import RecordFit, fit_record
from nrs_design.identification.tissue.problem import LeastSquaresProblem, box
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import (
    LAWS,
    AbstractContactLaw,
    KelvinBoltzmann,
    Maxwell,
)
from nrs_design.models.contact.motion import Motion
from nrs_design.proof.text import counted
from tests.identification.synthetic import CONCHA, pressing, tissue_record
from tests.identification.unilateral import push

Array = NDArray[np.float64]
T = TypeVar("T")
Kinds = Sequence[type[AbstractContactLaw]]

RECORDS, SAMPLES = 10, 10_000
# Beside the peer in contact from the beginning, and beside the peer that fits offsets, too.
TARGET, TARGET_OF_OFFSETS = 20.0, 1000.0
# Where the surface is for the robot, how far above it the probe turns, and the force in air.
ZERO, AIR, TARE = 0.1, 0.03, -0.05
NOISE = 0.008


def run(size: Size) -> tuple[Comparison, ...]:
    """Measure all fits in one run; quick: the peer does one record, its time counts ten times."""
    return (
        _compare("", _in_contact, TARGET, size),
        _compare(", with air: zero and tare too", _with_air, TARGET_OF_OFFSETS, size),
    )


def _compare(
    what: str, make: Callable[[int, int], TissueRecord], target: float, size: Size
) -> Comparison:
    every = tuple(LAWS.values())
    kinds = size.pick(every, every, every[:1])
    count, samples = size.pick((RECORDS, SAMPLES), (RECORDS, SAMPLES), (1, 300))
    quick = size is Size.QUICK
    work = f"{counted(len(kinds), 'law')}, {counted(count, 'record')} of {samples:,} samples{what}"
    records = [make(seed, samples) for seed in range(count)]
    # Imports are not what is measured.
    fit_record(KelvinBoltzmann, records[0])
    ours, fits = _timed(lambda: [_fit_all(record, kinds) for record in records])
    used = records[:1] if quick else records
    theirs, peers = _timed(lambda: [_peer_all(record, kinds) for record in used])
    excess = max(
        peer / fit.rmse - 1
        for row, other in zip(fits, peers, strict=False)
        for fit, peer in zip(row, other, strict=True)
    )
    note = f"RMSE of the peer at most {100 * excess:+.2g} % from ours; ours with three starts, "
    note += "contact, offsets, covariance and tests"
    note += ", peer on one record, times ten" if quick else ""
    scale = len(records) / len(used)
    return Comparison(work, "least_squares + solve_ivp", theirs * scale, ours, target, note)


def _in_contact(seed: int, samples: int) -> TissueRecord:
    motion, force = tissue_record(CONCHA, _presses(seed, samples), NOISE, seed)
    return _named(seed, motion, force)


def _with_air(seed: int, samples: int) -> TissueRecord:
    """Presses from above the surface, in coordinates of the robot, with a sensor not tared."""
    presses = _presses(seed, samples)
    force = push(CONCHA, Motion(presses.time, presses.deflection - AIR))
    force += np.random.default_rng([seed, 3]).normal(scale=NOISE, size=len(force))
    return _named(seed, Motion(presses.time, presses.deflection - AIR + ZERO), force + TARE)


def _presses(seed: int, samples: int) -> Motion:
    return pressing(100.0, (samples - 1) / 100.0, 0.3, 20.0, seed)


def _named(seed: int, motion: Motion, force: Array) -> TissueRecord:
    return TissueRecord(Source(Path(f"{seed}.csv"), str(seed), True), motion, force, True)


def _timed(function: Callable[[], T]) -> tuple[float, T]:
    """Take processor time: the peer works so long that other work comes and goes meanwhile."""
    start = process_time()
    result = function()
    return process_time() - start, result


def _fit_all(record: TissueRecord, kinds: Kinds) -> Sequence[RecordFit]:
    """Fit as `identify` does: what is in contact is found once for all laws."""
    trial = prepare(record)
    return [fit_record(kind, trial) for kind in kinds]


def _peer_all(record: TissueRecord, kinds: Kinds) -> Sequence[float]:
    return [_peer(kind, record) for kind in kinds]


def _peer(kind: type[AbstractContactLaw], record: TissueRecord) -> float:
    """Fit as one would by hand: one start (the best of ours), differences for the Jacobian.

    The tare is a parameter, and so is the zero where the record begins in air; what is above the
    surface has no deflection, and no force is negative. Returns the root of the mean square error.
    """
    trial = prepare(record)
    starts = LeastSquaresProblem(kind, trial).starts()
    start = min(starts, key=lambda point: point.cost).law
    low, high = box(kind, trial)
    parameters = np.clip(np.log(start.values), low + 1e-6, high - 1e-6)
    in_air = record.motion.deflection[0] > 0
    extra = [record.force[0], record.motion.deflection[0] + AIR / 2] if in_air else [0.0]
    wide = np.full(len(extra), np.inf)

    def missed(x: Array) -> Array:
        law, tare, zero = kind(*np.exp(x[: len(low)])), x[len(low)], x[len(low) + 1 :]
        if not in_air:
            return _simulate(law, record.motion) + tare - record.force
        pressed = np.maximum(record.motion.deflection - zero[0], 0.0)
        force = np.maximum(_simulate(law, Motion(record.motion.time, pressed)), 0.0)
        return np.asarray(force + tare - record.force)

    # Differences must be larger than the errors of the integration.
    found = least_squares(
        missed,
        np.append(parameters, extra),
        bounds=(np.append(low, -wide), np.append(high, wide)),
        diff_step=1e-4,
    )
    return float(np.sqrt(np.mean(found.fun**2)))


def _simulate(law: AbstractContactLaw, motion: Motion) -> Array:
    """Integrate the laws with memory; the others have a closed form, for the peer, too."""
    if isinstance(law, Maxwell):
        stiff, soft, tau = law.k, 0.0, law.relaxation_time
    elif isinstance(law, KelvinBoltzmann):
        soft, _, tau = law.eta
        stiff = law.k2 - soft
    else:
        return law.simulate(motion)
    slopes = motion.increments / motion.steps
    step = float(motion.steps[0])

    def derivative(t: float, y: Array) -> Array:
        return slopes[min(int(t / step), len(slopes) - 1)] - y / tau

    span = (0.0, float(motion.time[-1]))
    # Without a largest step, the first rest makes it so long that a press is skipped.
    options = {"rtol": 1e-8, "atol": 1e-10, "max_step": 20 * step}
    run = solve_ivp(derivative, span, [0.0], t_eval=motion.time, **options)
    return soft * motion.deflection + stiff * run.y[0]
