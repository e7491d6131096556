"""Five tissue laws with their offsets on ten records of 10,000 samples each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from benchmarks.measure import Comparison
from nrs_design.identification.datasets import Source, TissueRecord
from nrs_design.identification.tissue.offsets import offset_columns, offset_names
from nrs_design.identification.tissue.output_error import RecordFit, fit_record, rmse
from nrs_design.identification.tissue.starts import box, scan
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import LAWS, AbstractContactLaw, KelvinBoltzmann, Maxwell
from tests.identification.synthetic import CONCHA, pressing, tissue_record

Array = NDArray[np.float64]
T = TypeVar("T")

RECORDS, SAMPLES = 10, 10_000
TARGET = 20.0


def run(quick: bool) -> tuple[Comparison, ...]:
    """Measure all fits in one run; quick: the peer does one record, its time counts ten times."""
    records = [_record(seed) for seed in range(RECORDS)]
    # Imports are not what is measured.
    fit_record(KelvinBoltzmann, records[0])
    ours, fits = _timed(lambda: [_fit_all(record) for record in records])
    used = records[:1] if quick else records
    theirs, peers = _timed(lambda: [_peer_all(record) for record in used])
    excess = max(
        rmse(peer, fit.record) / fit.rmse - 1
        for row, other in zip(fits, peers, strict=False)
        for fit, peer in zip(row, other, strict=True)
    )
    note = f"RMSE of the peer at most {100 * excess:+.2g} % from ours; ours with three starts, "
    note += "offsets, covariance and tests" + (", peer on one record, times ten" if quick else "")
    work = "five laws, ten records of 10,000 samples"
    scale = len(records) / len(used)
    return (Comparison(work, "least_squares + solve_ivp", theirs * scale, ours, TARGET, note),)


def _record(seed: int) -> TissueRecord:
    motion = pressing(100.0, (SAMPLES - 1) / 100.0, 0.3, 20.0, seed)
    motion, force = tissue_record(CONCHA, motion, 0.008, seed)
    return TissueRecord(Source(Path(f"{seed}.csv"), str(seed), True), motion, force, True)


def _timed(function: Callable[[], T]) -> tuple[float, T]:
    start = perf_counter()
    result = function()
    return perf_counter() - start, result


def _fit_all(record: TissueRecord) -> Sequence[RecordFit]:
    return [fit_record(kind, record) for kind in LAWS.values()]


def _peer_all(record: TissueRecord) -> Sequence[AbstractContactLaw]:
    return [_peer(kind, record) for kind in LAWS.values()]


def _peer(kind: type[AbstractContactLaw], record: TissueRecord) -> AbstractContactLaw:
    """Fit as one would by hand: one start (the best of ours), differences for the Jacobian."""
    trial = prepare(record)
    offsets = offset_columns(offset_names(kind, trial), trial)
    start = min(scan(kind, trial, offsets), key=lambda law: rmse(law, trial))
    low, high = box(kind, trial)
    x0 = np.append(np.clip(np.log(start.values), low + 1e-6, high - 1e-6), 0.0)
    # Differences must be larger than the errors of the integration.
    found = least_squares(
        lambda x: _simulate(kind(*np.exp(x[:-1])), record) + x[-1] - record.force,
        x0,
        bounds=(np.append(low, -np.inf), np.append(high, np.inf)),
        diff_step=1e-4,
    )
    return kind(*np.exp(found.x[:-1]).tolist())


def _simulate(law: AbstractContactLaw, record: TissueRecord) -> Array:
    """Integrate the laws with memory; the others have a closed form, for the peer, too."""
    motion = record.motion
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
