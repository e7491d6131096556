"""The actuator from all the data there are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.errors import DataError
from nrs_design.identification.actuator.frequency_fit import fit_phasors, fit_response
from nrs_design.identification.actuator.model import ActuatorFit, MotorFigures
from nrs_design.identification.actuator.phasors import Phasors, phasors_of
from nrs_design.identification.actuator.time_fit import fit_angles
from nrs_design.identification.datasets import FrequencyResponse, SinusoidRecord, Source
from nrs_design.models.actuator import MotorConstants

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

# Time-domain fits take every record as one batch and need some beyond the three parameters.
_FEWEST_RECORDS = 5


@dataclass(frozen=True, slots=True, eq=False)
class ActuatorIdentification:
    """Fits of one actuator.

    Parameters
    ----------
    sources : tuple of Source
        The files.
    records : tuple of SinusoidRecord
        None for a ready response.
    phasors : tuple of Phasors
        One for each record.
    fits : tuple of ActuatorFit
        Every method that the data allow.
    chosen : ActuatorFit
        The last of them.
    reason : str
        Why that one.
    figures : MotorFigures
        Derived from it and the data sheet.
    frequency : ndarray, shape (m,)
        In rad/s.
    response : ndarray of complex, shape (m,)
        Velocity over command without friction, in (rad/s)/rpm.
    """

    sources: tuple[Source, ...]
    records: tuple[SinusoidRecord, ...]
    phasors: tuple[Phasors, ...]
    fits: tuple[ActuatorFit, ...]
    chosen: ActuatorFit
    reason: str
    figures: MotorFigures
    frequency: Array
    response: Complex

    @property
    def synthetic(self) -> bool:
        """Whether any of the data are synthetic."""
        return any(source.synthetic for source in self.sources)


def identify_actuator(
    data: Sequence[SinusoidRecord | FrequencyResponse],
    motor: MotorConstants,
    progress: Callable[[str], None] = lambda step: None,
) -> ActuatorIdentification:
    """Fit gain, time constant and friction.

    Parameters
    ----------
    data : sequence
        Sinusoid records at three frequencies or more, or one ready frequency response.
    motor : MotorConstants
        Data sheet, for resistance and speed-torque gradient.
    progress : callable
        Told the name of each step.

    Raises
    ------
    DataError
        If there are no data, both kinds are mixed, or they do not determine the model.
    """
    responses = [item for item in data if isinstance(item, FrequencyResponse)]
    records = [item for item in data if isinstance(item, SinusoidRecord)]
    if not data or (responses and records) or len(responses) > 1:
        raise DataError(
            f"{len(records)} sinusoid records and {len(responses)} frequency responses",
            remedy="give sinusoid records, or one frequency response",
        )
    if len({(r.source.sha256, r.group) for r in records}) < len(records):
        raise DataError(
            "a record is there twice, which would narrow the intervals", remedy="name it once"
        )
    progress("complex response")
    if responses:
        return _from_response(responses[0], motor)
    return _from_records(records, motor, progress)


def _from_response(data: FrequencyResponse, motor: MotorConstants) -> ActuatorIdentification:
    fit = fit_response(data)
    return ActuatorIdentification(
        sources=(data.source,),
        records=(),
        phasors=(),
        fits=(fit,),
        chosen=fit,
        reason="A ready response allows nothing else; friction cannot be told from it.",
        figures=fit.figures(motor),
        frequency=data.frequency,
        response=data.response,
    )


def _from_records(
    records: Sequence[SinusoidRecord], motor: MotorConstants, progress: Callable[[str], None]
) -> ActuatorIdentification:
    phasors = tuple(phasors_of(record) for record in records)
    fits = [fit_phasors(phasors)]
    reason = f"fewer than {_FEWEST_RECORDS} records: their spread cannot be judged in time."
    if len(records) >= _FEWEST_RECORDS:
        progress("time domain")
        fits.append(fit_angles(records, fits[0]))
        reason = "the fit to the angles uses every sample."
    chosen = fits[-1]
    friction = chosen.friction.value if chosen.friction else 0.0
    V = np.array([p.velocity for p in phasors])
    U = np.array([p.command for p in phasors])
    sources = {record.source.sha256: record.source for record in records}
    return ActuatorIdentification(
        sources=tuple(sources.values()),
        records=tuple(records),
        phasors=phasors,
        fits=tuple(fits),
        chosen=chosen,
        reason=reason[0].upper() + reason[1:],
        figures=chosen.figures(motor),
        frequency=np.array([p.frequency for p in phasors]),
        response=V / (U - 4 / np.pi * friction * V / np.abs(V)),
    )
