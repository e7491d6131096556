"""Reasons to doubt that a record determines the parameters of a law."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nrs_design.identification.datasets.records import doubt_step, question_sizes
from nrs_design.identification.numeric import Array, column_sizes
from nrs_design.identification.rounding import rounding_of_velocity
from nrs_design.identification.statistics import WHITE, Uncertainty, ljung_box, student_quantile
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import AbstractContactLaw, AbstractLinearLaw
from nrs_design.models.contact.law import DAMPING, STIFFNESS
from nrs_design.spec.plausible import doubt_size

# Largest residual, and largest structure in it, as parts of the range of the force.
LARGEST_RESIDUAL = 0.1
LARGEST_STRUCTURE = 0.03
LEAST_R2 = 0.9
# A cycle that is stiffer than the others by this much is conditioning.
_CONDITIONING = 0.05
_BINS = 12
_SPREADS = 3.0
_NOT_LINEAR = "follow the deflection: the tissue is not linear in it"
_OTHERWISE_DAMPED = "follow the velocity: the law has another damping"
_WANDERING = "are not white but wander with time"
# Decrease of BIC by a tare that moves.
_BIC = 10.0
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
    """Return the doubts about a fit as sentences; empty for a sound fit.

    Bounds are the logarithms, lower and upper, between which the parameters were sought.
    """
    wrong = (*_units(trial), *_signs(trial, residuals))
    # A record in wrong units makes the sizes of its parameters meaningless.
    read = wrong or tuple(_sizes(law, rotational=trial.record.rotational))
    return (
        *read,
        *_size(trial, residuals),
        *_structure(trial, residuals),
        *_drift(trial, residuals, sensitivities),
        *_conditioning(trial, residuals),
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
    yield from question_sizes(zip(law.keys, law.parameters(), law.values, units, strict=True))


def _units(trial: Trial) -> Iterator[str]:
    """Doubt a record of a size that no probe of a robot meets: its units are likely others."""
    rotational = trial.record.rotational
    for values, quantity, name, unit in (
        (trial.motion.deflection, "deflection", ("deflection", "angle"), ("m", "rad")),
        (trial.measured, "torque" if rotational else "force", ("force", "torque"), ("N", "N*m")),
    ):
        span = float(np.ptp(values))
        field, si = f"recorded_{name[rotational]}", unit[rotational]
        if question := doubt_size(field, span, si, f"{span:.3g}"):
            yield f"the {quantity} spans {span:.3g} {si}: {question} (--map names another)"
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


def _explained(trial: Trial, residuals: Array) -> float:
    """Return R², the part of the variance of the force that a fit explains."""
    total = float(np.var(trial.measured))
    return 1 - float(np.mean(residuals**2)) / total if total else 0.0


def structure(values: Array, residuals: Array) -> tuple[float, float]:
    """Tell how residuals follow a quantity, by their means in groups of equal size.

    Return the root mean square of what they follow, in N (N m), and the p-value of the F-test of
    one-way analysis of variance.
    """
    from scipy.special import fdtrc

    order = np.argsort(values, kind="stable")
    groups = np.array_split(residuals[order], _BINS)
    means = np.array([group.mean() for group in groups])
    sizes = np.array([len(group) for group in groups])
    noise = sum(float(np.sum((g - m) ** 2)) for g, m in zip(groups, means, strict=True))
    noise /= len(residuals) - _BINS
    effect = float(sizes @ (means - residuals.mean()) ** 2) / (_BINS - 1)
    if noise == 0.0:
        return 0.0, 1.0
    power = max(0.0, (effect - noise) * (_BINS - 1) / len(residuals))
    return power**0.5, float(fdtrc(_BINS - 1, len(residuals) - _BINS, effect / noise))


def _signs(trial: Trial, residuals: Array) -> Iterator[str]:
    """Doubt the sign of the force, unless a law, which pushes back, explains it well."""
    if _explained(trial, residuals) < LEAST_R2 and not _takes_work(trial):
        yield (
            "force and deflection have opposite signs: the tissue gives back more work than it "
            "takes (--set negate=true if the sensor measures the force on the probe)"
        )


def _takes_work(trial: Trial) -> bool:
    """Tell whether the probe works on the tissue; with a wrong sign, it is worked on.

    Forces count from the first one: no passive tissue gives back more than it has taken.
    """
    x, force = trial.deflection, trial.measured
    added = (force[1:] + force[:-1]) / 2 - force[0]
    work = np.cumsum(added * np.diff(x))
    return float(work.max()) >= -float(work.min())


def _size(trial: Trial, residuals: Array) -> Iterator[str]:
    part = float(np.sqrt(np.mean(residuals**2))) / trial.span
    r2 = _explained(trial, residuals)
    if part > LARGEST_RESIDUAL or r2 < LEAST_R2:
        yield f"the residual is {100 * part:.2g} % of the range of the force (R² = {r2:.2g})"


def _structure(trial: Trial, residuals: Array) -> Iterator[str]:
    touching = trial.touching[trial.fit_mask]
    contact_residuals = residuals[touching]
    motion, span = trial.motion, trial.span
    velocity = motion.velocity[trial.fit_mask][touching]
    wander, _ = structure(motion.time[trial.fit_mask], residuals)
    for (size, p), test, pattern in (
        (structure(trial.deflection[touching], contact_residuals), "F-test", _NOT_LINEAR),
        (structure(velocity, contact_residuals), "F-test", _OTHERWISE_DAMPED),
        ((wander, ljung_box(residuals)), "Ljung-Box", _WANDERING),
    ):
        if size > LARGEST_STRUCTURE * span and p < WHITE:
            # A p-value that leaves the floats is not 0.
            p_text = f"p = {p:.1g}" if p > 1e-99 else "p < 1e-99"
            part = f"{100 * size / span:.2g} % of the range of the force, {test} {p_text}"
            yield f"the residuals {pattern} ({part})"


def _drift(trial: Trial, residuals: Array, sensitivities: Array) -> Iterator[str]:
    """Doubt a tare that moves, straight or bent, where no air was asked."""
    if trial.contact is not None:
        return
    time = trial.motion.time[trial.fit_mask]
    part = (time - time[0]) / (time[-1] - time[0])
    gain = _gain(residuals, sensitivities, np.column_stack([part, part**2]))
    if gain > _BIC:
        yield (
            f"a tare that moves with time fits better (BIC {gain:.3g} less), and no air shows "
            "whether it does: record air before and after"
        )


def _gain(residuals: Array, sensitivities: Array, columns: Array) -> float:
    """Return the decrease of BIC by more columns, shape (n, q), in a linearized fit."""
    n = len(residuals)
    X = np.column_stack([sensitivities, columns])
    size = column_sizes(X)
    found, _, rank, _ = np.linalg.lstsq(X / size, residuals, rcond=1e-9)
    left = residuals - (X / size) @ found
    difference = int(rank) - np.linalg.matrix_rank(sensitivities / size[: sensitivities.shape[1]])
    if difference < 1 or not (left @ left):
        return 0.0
    fall = float(np.log((residuals @ residuals) / (left @ left)))
    gain = n * fall - float(difference) * float(np.log(n))
    # Colored residuals hold fewer samples than they count.
    return gain * (1.0 if ljung_box(left) >= WHITE else _BINS / n * 2)


def _conditioning(trial: Trial, residuals: Array) -> Iterator[str]:
    """Compare the first loading cycle with the later ones (Mullins effect)."""
    errors, fitted = np.full(len(trial.force), np.nan), np.full(len(trial.force), np.nan)
    errors[trial.fit_mask] = residuals
    fitted[trial.fit_mask] = trial.measured - residuals - (trial.measured - residuals).min()
    gains = []
    for cycle in trial.cycles:
        cycle_mask = np.isfinite(errors[cycle])
        f = fitted[cycle][cycle_mask]
        if cycle_mask.sum() >= _BINS and np.ptp(f) > 0.5 * trial.span:
            gains.append(float(f @ errors[cycle][cycle_mask]) / float(f @ f))
    if len(gains) < 3:
        return
    first, later = gains[0], np.array(gains[1:])
    difference = first - float(later.mean())
    if abs(difference) > max(_CONDITIONING, _SPREADS * float(np.ptp(later))):
        word = "stiffer" if difference > 0 else "softer"
        start = trial.motion.time[trial.cycles[1].start]
        yield (
            f"the first loading cycle is {100 * abs(difference):.2g} % {word} than the later ones "
            f"(conditioning): --set start={start:.4g} sets it apart"
        )
