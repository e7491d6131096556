"""Mass, center of mass and bias of what hangs on a force sensor, from poses at rest.

In a pose with the gravity g along the axes of the sensor it measures ``F = m g + F0`` and
``T = c x m g + T0``: linear in m, F0, the first moment m c, and T0.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.datasets import PoseRecord, Source
from nrs_design.identification.numeric import Array
from nrs_design.identification.statistics import Estimate, student_quantile
from nrs_design.spec.plausible import doubt_size

# In m/s^2, where nobody says another.
GRAVITY = 9.81
# Three poses determine all; from so many on, an error of one of them shows.
_FEWEST, _ENOUGH = 3, 6
# Spread of the directions of gravity, as a part of their length: below it poses are alike.
_ALIKE, _FLAT = 0.1, 0.02
# Residuals, as a part of what the weight does.
_MISSED = 0.02
# In standard deviations.
_OUTLIER = 5.0
# A cause is named where it leaves less than this part of the errors.
_LEAVES = 0.5
# A smaller angle, in rad, is within the tolerance of mounting.
_STRAIGHT = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class ToolIdentification:
    """What poses at rest say about a tool, with 95 % intervals."""

    records: tuple[PoseRecord, ...]  # The data
    gravity: float  # In m/s^2
    mass: Estimate  # In kg
    center: tuple[Estimate, ...]  # Center of mass from the origin of the sensor, in m: x, y, z
    # force_bias, torque_bias: what the sensor shows without the tool, in N and N m: x, y, z.
    force_bias: tuple[Estimate, ...]
    torque_bias: tuple[Estimate, ...]
    # force_errors, torque_errors: shape (n, 3). Measured less fitted, in N and N m.
    force_errors: Array
    torque_errors: Array
    doubts: tuple[str, ...]  # What speaks against it

    @property
    def rmse(self) -> tuple[float, float]:
        """Root mean square of the errors of force and torque, in N and N m."""
        force, torque = (np.sqrt(np.mean(e**2)) for e in (self.force_errors, self.torque_errors))
        return float(force), float(torque)

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files."""
        return tuple(record.source for record in self.records)

    @property
    def remarks(self) -> tuple[str, ...]:
        """None."""
        return ()

    @property
    def caveats(self) -> tuple[str, ...]:
        """The doubts."""
        return self.doubts


def identify_tool(records: Sequence[PoseRecord], gravity: float) -> ToolIdentification:
    """Fit a tool by least squares.

    Parameters
    ----------
    records : sequence of PoseRecord
        Poses of one sensor with one tool.
    gravity : float
        In m/s^2.

    Raises
    ------
    DataError
        If the poses do not determine the tool, or its mass would not be positive.
    """
    down, force, torque = _columns(records)
    spread = _spread(down, records)
    weight = gravity * down
    n, unit = len(down), np.tile(np.eye(3), (len(down), 1))
    forces = _fit(np.column_stack([weight.reshape(-1), unit]), force.reshape(-1))
    # p x w = -[w]x p.
    x, y, z = weight.T
    zero = np.zeros(n)
    cross = np.stack([[zero, z, -y], [-z, zero, x], [y, -x, zero]]).transpose(2, 0, 1)
    torques = _fit(np.column_stack([cross.reshape(-1, 3), unit]), torque.reshape(-1))
    mass = forces.estimates()[0]
    if mass.value <= 0:
        against = f"the forces point against the weight: the mass would be {mass.value:.4g} kg"
        cause = _likely_cause(records, forces.errors)
        raise DataError(
            against if cause is None else f"{against}; {cause}",
            path=records[0].source.path,
            remedy="the sensor measures the force on the tool, or the orientation is that of the "
            "world in the sensor: turn the signs, or the rotation",
        )
    errors = (forces.errors.reshape(n, 3), torques.errors.reshape(n, 3))
    center = _center(forces, torques)
    return ToolIdentification(
        tuple(records),
        gravity,
        mass,
        center,
        forces.estimates()[1:],
        torques.estimates()[3:],
        *errors,
        (
            *_sizes(mass.value, center),
            *_doubts(records, spread, errors, mass.value * gravity, center),
        ),
    )


def _sizes(mass: float, center: Sequence[Estimate]) -> tuple[str, ...]:
    """Return what is asked about the sizes of what was found."""
    away = math.hypot(*(estimate.value for estimate in center))
    sizes = ("mass", "mass", mass, "kg"), ("distance of its center", "center_of_mass", away, "m")
    asked = ((what, value, si, doubt_size(field, value, si)) for what, field, value, si in sizes)
    return tuple(f"the {what} is {v:.4g} {si}: {said}" for what, v, si, said in asked if said)


@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    """A linear least-squares fit with white errors."""

    values: Array
    covariance: Array
    degrees: int
    errors: Array

    def estimates(self) -> tuple[Estimate, ...]:
        half = student_quantile(self.degrees) * np.sqrt(np.diag(self.covariance))
        pairs = zip(self.values.tolist(), half.tolist(), strict=True)
        return tuple(Estimate(value, value - h, value + h) for value, h in pairs)


def _fit(J: Array, measured: Array) -> _Fit:
    values = np.linalg.lstsq(J, measured, rcond=None)[0]
    errors = measured - J @ values
    degrees = len(measured) - J.shape[1]
    variance = float(errors @ errors) / degrees
    covariance: Array = variance * np.linalg.inv(J.T @ J)
    return _Fit(np.asarray(values, np.float64), covariance, degrees, errors)


def _center(forces: _Fit, torques: _Fit) -> tuple[Estimate, ...]:
    """Return the first moment over the mass; their errors are taken for independent."""
    mass, variance = float(forces.values[0]), float(forces.covariance[0, 0])
    quantile = student_quantile(min(forces.degrees, torques.degrees))
    found = []
    for i in range(3):
        at = float(torques.values[i]) / mass
        half = quantile * math.sqrt(float(torques.covariance[i, i]) + at**2 * variance) / mass
        found.append(Estimate(at, at - half, at + half))
    return tuple(found)


def _spread(down: Array, records: Sequence[PoseRecord]) -> Array:
    """Return the spread of the directions of gravity along their own axes, the largest first.

    Raises
    ------
    DataError
        If they are too few, or too much alike.
    """
    path = records[0].source.path
    if len(down) < _FEWEST:
        raise DataError(
            f"{len(down)} poses do not determine a tool",
            path=path,
            remedy=f"record {_FEWEST} poses at least, better {_ENOUGH} or more, a row each",
        )
    spread: Array = np.linalg.svd(down - down.mean(axis=0), compute_uv=False) / math.sqrt(len(down))
    if spread[1] < 1e-3:
        raise DataError(
            "the poses lean one way only: they do not determine the center of mass",
            path=path,
            remedy="tilt the tool about two axes",
        )
    return spread


def _doubts(
    records: Sequence[PoseRecord],
    spread: Array,
    errors: tuple[Array, Array],
    weight: float,
    center: Sequence[Estimate],
) -> Iterator[str]:
    count = len(errors[0])
    cause = _likely_cause(records, errors[0])
    if count < _ENOUGH:
        yield f"{count} poses are few: an error in one of them hardly shows"
    if spread[1] < _ALIKE:
        yield "the poses are much alike: their directions of gravity hardly spread"
    elif spread[2] < _FLAT:
        yield "all directions of gravity lie in one plane: an error across it does not show"
    arm = math.hypot(*(estimate.value for estimate in center))
    for name, misses, size in (("force", errors[0], weight), ("torque", errors[1], weight * arm)):
        rms = float(np.sqrt(np.mean(misses**2)))
        if rms > _MISSED * size:
            part = f"{100 * rms / size:.2g} %" if size else "all"
            why = "the orientation is off, the tool moved or was touched"
            if name == "force" and cause is not None:
                why = cause
            yield f"the {name} misses the fit by {part} of what the weight does: {why}"
        worst = np.abs(misses).max(axis=1)
        row = int(worst.argmax())
        others = np.delete(misses, row, axis=0)
        usual = float(np.sqrt(np.mean(others**2)))
        if count >= _ENOUGH and worst[row] > _OUTLIER * usual > 0:
            yield f"pose {row + 1} is off in {name}: leave it out, or record it again"


def _columns(records: Sequence[PoseRecord]) -> tuple[Array, Array, Array]:
    """Return directions of gravity, forces and torques of all poses."""
    down, force, torque = (
        np.concatenate([getattr(record, name) for record in records])
        for name in ("down", "force", "torque")
    )
    return down, force, torque


def _likely_cause(records: Sequence[PoseRecord], errors: Array) -> str | None:
    """Name what would explain the forces far better, with what it leaves; or None.

    All causes are common: the rotation is written the other way round, the wrench is given along
    the axes of the world, or the sensor is mounted askew on the frame whose orientation is
    recorded.
    """
    if errors.size < 3 * _ENOUGH:
        return None
    left, weight, words = min(_causes(records), default=(math.inf, 1.0, ""))
    if left > _LEAVES * float(np.sqrt(np.mean(errors**2))) or weight <= 0:
        return None
    return f"likely {words}: then it would miss {100 * left / weight:.2g} %"


def _causes(records: Sequence[PoseRecord]) -> Iterator[tuple[float, float, str]]:
    """Yield what each cause leaves, the weight by it, both in N, and its words."""
    down, force, _ = _columns(records)
    askew, *found = _turned(down, force)
    if askew > _STRAIGHT:
        words = f"the sensor is mounted askew by {math.degrees(askew):.3g} deg"
        yield found[0], found[1], words
    turns = [record.turns for record in records if record.turns is not None]
    if len(turns) < len(records):
        return
    turn = np.concatenate(turns)
    yield *_left(-turn[:, :, 2], force), "the orientation is that of the world in the sensor"
    along = np.einsum("nji,nj->ni", turn, force)
    yield *_left(down, along), "the wrench is given along the axes of the world"


def _left(down: Array, force: Array) -> tuple[float, float]:
    """Return what a weight and a bias along the axes of the sensor leave, and that weight."""
    D, F = down - down.mean(axis=0), force - force.mean(axis=0)
    weight = float(np.sum(D * F) / np.sum(D * D))
    return float(np.sqrt(np.mean((F - weight * D) ** 2))), weight


def _turned(down: Array, force: Array) -> tuple[float, float, float]:
    """Return the angle of the rotation that fits best, what it leaves, and the weight by it."""
    D, F = down - down.mean(axis=0), force - force.mean(axis=0)
    U, _, Vt = np.linalg.svd(F.T @ D)
    Q = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    angle = math.acos(min(max((float(np.trace(Q)) - 1) / 2, -1.0), 1.0))
    return angle, *_left(down @ Q.T, force)
