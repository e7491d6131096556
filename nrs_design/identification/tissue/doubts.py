"""Reasons to doubt that a record determines the parameters of a law."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nrs_design.identification.datasets.checks import doubt_step
from nrs_design.identification.numeric import Array
from nrs_design.identification.rounding import rounding_of_velocity
from nrs_design.identification.statistics import Uncertainty, student_quantile
from nrs_design.identification.tissue.residuals import doubt_residuals, doubt_signs
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import AbstractContactLaw, AbstractLinearLaw
from nrs_design.models.contact.law import DAMPING, STIFFNESS
from nrs_design.spec.plausible import doubt_size

LARGEST_ERROR = 0.5
# Distance from a bound, in the logarithm, that counts as reaching it.
_BOUND_DISTANCE = 1e-3
# Part of the power of the velocity that may be rounding of the deflection.
_ROUNDING = 0.1
# Standard errors by which an estimate may be off on average.
_BIAS = 0.5
_LOADED = 0.1


def doubts(
    law: AbstractContactLaw,
    trial: Trial,
    uncertainty: Uncertainty,
    bounds: tuple[Array, Array],
    residuals: Array,
    sensitivities: Array,
) -> tuple[str, ...]:
    """Return the doubts about a fit, in words; none for a sound fit.

    Bounds are the logarithms, lower and upper, between which the parameters were sought.
    """
    wrong = (*_units(trial), *doubt_signs(trial, residuals))
    # A record in wrong units makes the sizes of its parameters meaningless.
    read = wrong or tuple(_sizes(law, rotational=trial.record.rotational))
    return (
        *read,
        *doubt_residuals(trial, residuals, sensitivities),
        *_bounds(law, bounds),
        *_errors(law, uncertainty),
        *_times(law, trial),
        *_motion(law, trial, uncertainty),
    )


def _sizes(law: AbstractContactLaw, *, rotational: bool) -> Iterator[str]:
    """Doubt parameters of a size that no tissue has under a robot."""
    if not isinstance(law, AbstractLinearLaw):
        return
    units = law.units(rotational=rotational)
    for name, key, value, si in zip(law.parameters(), law.keys, law.values, units, strict=True):
        if question := doubt_size(key, value, si, f"{value:.3g}"):
            yield f"{name} is {value:.3g} {si}: {question}"


def _units(trial: Trial) -> Iterator[str]:
    """Doubt a record of a size that no probe of a robot meets: its units are likely others."""
    rotational = trial.record.rotational
    for values, what, name, unit in (
        (trial.motion.deflection, "deflection", ("deflection", "angle"), ("m", "rad")),
        (trial.measured, "torque" if rotational else "force", ("force", "torque"), ("N", "N*m")),
    ):
        span = float(np.ptp(values))
        field, si = f"recorded_{name[rotational]}", unit[rotational]
        if question := doubt_size(field, span, si, f"{span:.3g}"):
            yield f"the {what} spans {span:.3g} {si}: {question} (--map names another)"
    yield from doubt_step(trial.step)


def _bounds(law: AbstractContactLaw, bounds: tuple[Array, Array]) -> Iterator[str]:
    logs = np.log(law.values)
    for name, log, low, high in zip(law.parameters(), logs, *bounds, strict=True):
        if min(log - low, high - log) < _BOUND_DISTANCE:
            end = "lower" if log - low < high - log else "upper"
            yield f"{name} is at the {end} end of its box"


def reaches_zero(law: AbstractContactLaw, uncertainty: Uncertainty) -> tuple[bool, ...]:
    """Tell of each parameter whether it is a stiffness that the 95 % interval lets be 0."""
    quantile = student_quantile(uncertainty.degrees)
    pairs = zip(law.kinds, uncertainty.errors, strict=True)
    return tuple(kind == STIFFNESS and not quantile * error < 1 for kind, error in pairs)


def _errors(law: AbstractContactLaw, uncertainty: Uncertainty) -> Iterator[str]:
    zeros = reaches_zero(law, uncertainty)
    for name, error, zero in zip(law.parameters(), uncertainty.errors, zeros, strict=True):
        if not error <= LARGEST_ERROR:
            size = f"{100 * error:.0f} %" if error < 10 else "over 1000 %"
            yield f"{name} has a relative standard error of {size}"
        if zero:
            yield f"the interval of {name} reaches 0"


def _times(law: AbstractContactLaw, trial: Trial) -> Iterator[str]:
    tau = law.relaxation_time
    if tau is None:
        return
    if tau > trial.duration:
        yield (
            f"the record ({trial.duration:.3g} s) is shorter than the relaxation time ({tau:.3g} s)"
        )
    if tau < trial.step:
        yield (
            f"the relaxation time ({tau:.3g} s) is below the step of the record "
            f"({trial.step:.3g} s)"
        )


def _motion(law: AbstractContactLaw, trial: Trial, uncertainty: Uncertainty) -> Iterator[str]:
    motion = trial.motion
    if law.takes_velocity:
        part = rounding_of_velocity(motion.time, trial.position)
        dampings = [kind.endswith(DAMPING) for kind in law.kinds]
        # A damping comes out too small by this part: by half a standard error, an interval that
        # should hold in 95 % of records holds in 92 %.
        if part > min(_ROUNDING, _BIAS * float(uncertainty.errors[dampings].min())):
            yield (
                f"{100 * min(part, 1.0):.2g} % of the power of the velocity is rounding of the "
                "deflection, so that the damping comes out too small"
            )
    start = abs(float(motion.deflection[0])) / float(np.abs(motion.deflection).max())
    if law.relaxation_time is not None and start > _LOADED:
        yield (
            f"the record begins at {100 * start:.0f} % of the deflection, which is taken as relaxed"
        )
