"""What a controller achieves at worst, beside what the spec asks for.

Margins are taken in every contact: at the nominal values of the environment that the controller is
designed for, and at all corners of the declared ranges of all its contacts and of its gains.
Displayed impedance and force error are what the design is for: they are taken with the designed
gains, in the environment that it is designed for, at its nominal values and at all corners of its
ranges. Values between corners are not looked at. All of it is floating point, and no proof.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from nrs_design.design.force_limit import NO_OFFSET, Approach, steady_force_error
from nrs_design.design.hands_on import hand_effort, transparency
from nrs_design.design.impedance import ImpedanceLoop
from nrs_design.design.loops import Loops, gain_extremes, multiply
from nrs_design.design.measures import (
    AT_HOME,
    CREEP,
    CREEP_ANGLE,
    DELAY_MARGIN,
    DISK_MARGIN,
    FORCE_ERROR,
    GAIN_MARGIN,
    HAND_EFFORT,
    IMPEDANCE_ERROR,
    PHASE_MARGIN,
    SENSITIVITY_PEAK,
    TRANSPARENCY,
    Measure,
)
from nrs_design.design.transfer import FloatArray, TransferFunction
from nrs_design.models.contact import AbstractLinearLaw
from nrs_design.models.contact.environment import Environment


@dataclass(frozen=True, slots=True)
class Achieved:
    """The worst value of one measure.

    Parameters
    ----------
    measure : Measure
        What is measured.
    value : float
        The worst value, in SI units.
    where : str
        The corner at which it is taken, such as ``soft, k = 44.2466 N*m/rad``.
    goal : float or None
        What the spec asks for, in SI units.
    """

    measure: Measure
    value: float
    where: str
    goal: float | None = None

    @property
    def met(self) -> bool:
        """Whether there is no goal, or the value reaches it."""
        return self.goal is None or self.measure.violation(self.value, self.goal) <= 0


@dataclass(frozen=True, slots=True)
class ContactCorner:
    """One contact that a controller is measured in, and where its gains are then.

    Parameters
    ----------
    label : str
        For people.
    contact : AbstractLinearLaw
        The environment there.
    home : bool
        Whether this is the environment that the controller is designed for, with the designed
        gains.
    Mt, Bt : float or None
        End of a declared range of the gain; None is the designed gain.
    Kt : float
        Spring of the admittance, N m/rad; zero is none.
    """

    label: str
    contact: AbstractLinearLaw
    home: bool
    Mt: float | None = None
    Bt: float | None = None
    Kt: float = 0.0


@dataclass(frozen=True)
class Requirement:
    """Goals of one controller, and all that is needed to measure it.

    Parameters
    ----------
    motion : TransferFunction
        Closed motion loop G.
    corners : tuple of ContactCorner
        As `corners_of` gives them.
    goals : tuple of (Measure, float)
        Goals in SI units.
    desired : float
        Desired impedance, N m s/rad; impedance controllers only.
    bandwidth : float
        Highest frequency of the command, rad/s; impedance controllers only.
    lags : tuple of float
        Denominator of the filter of the force, whose numerator is 1.
    force_error : float
        Bound on the lasting error of the force signal, N m.
    """

    motion: TransferFunction
    corners: tuple[ContactCorner, ...]
    goals: tuple[tuple[Measure, float], ...] = ()
    desired: float = 0.0
    bandwidth: float = 0.0
    lags: tuple[float, ...] = (1.0,)
    force_error: float = 0.0

    def violation(self, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
        """Return by which part the worst goal is missed; not positive where all are met."""
        worst = np.full(len(Mt), -np.inf)
        for measure, goal in self.goals:
            values = self.values(measure, Mt, Bt)[0]
            missed = [measure.violation(float(value), goal) for value in values]
            worst = np.maximum(worst, missed)
        return worst

    def values(
        self, measure: Measure, Mt: FloatArray, Bt: FloatArray
    ) -> tuple[FloatArray, list[str]]:
        """Return the worst value of a measure for every admittance, and at which corner.

        Parameters
        ----------
        measure : Measure
            What is measured.
        Mt, Bt : ndarray, shape (m,)
            The admittances, kg m^2 and N m s/rad.
        """
        corners = [c for c in self.corners if c.home or measure not in AT_HOME]
        table = np.array([self._at(corner, measure, Mt, Bt) for corner in corners])
        worst = table.argmax(axis=0) if measure.upper else table.argmin(axis=0)
        values = np.take_along_axis(table, worst[None, :], axis=0)[0]
        in_the_air = measure in (CREEP, CREEP_ANGLE)
        return values, ["free motion" if in_the_air else corners[i].label for i in worst]

    def _at(
        self, corner: ContactCorner, measure: Measure, Mt: FloatArray, Bt: FloatArray
    ) -> FloatArray:
        Mt = Mt if corner.Mt is None else np.full_like(Mt, corner.Mt)
        Bt = Bt if corner.Bt is None else np.full_like(Bt, corner.Bt)
        if measure is CREEP:
            return np.zeros_like(Bt) if corner.Kt else self.force_error / Bt
        if measure is CREEP_ANGLE:
            return np.full_like(Bt, self.force_error / corner.Kt if corner.Kt else np.inf)
        loops = _impedance_loops(self, corner, Mt, Bt)
        if measure is TRANSPARENCY:
            return transparency(loops, self.bandwidth)
        if measure is HAND_EFFORT:
            return hand_effort(loops, corner.contact, self.bandwidth)
        if measure is not IMPEDANCE_ERROR:
            return _margin(loops, measure)
        if corner.Kt:  # Towards rest the robot displays the spring, and no damping.
            return np.full(len(Mt), np.inf)
        forward = multiply(loops.numerator, np.tile(self.lags, (len(Mt), 1)))
        displayed = multiply(forward, np.stack([Mt, Bt], axis=1))
        low, high = gain_extremes(displayed, loops.closed, self.bandwidth)
        error = np.maximum(high / self.desired, self.desired / low)
        return np.where(loops.stable, error, np.inf)


def achieve_impedance(
    requirement: Requirement, measures: tuple[Measure, ...], Mt: float, Bt: float
) -> tuple[Achieved, ...]:
    """Return the worst value of every measure of one admittance.

    Parameters
    ----------
    requirement : Requirement
        Where it is measured, and what is wanted.
    measures : tuple of Measure
        What is measured.
    Mt : float
        Virtual mass, kg m^2.
    Bt : float
        Virtual damping, N m s/rad.
    """
    goals = dict(requirement.goals)
    found = []
    for measure in measures:
        (value,), (where,) = requirement.values(measure, np.array([Mt]), np.array([Bt]))
        found.append(Achieved(measure, float(value), where, goals.get(measure)))
    return tuple(found)


def achieve_force(
    requirement: Requirement,
    measures: tuple[Measure, ...],
    gain: float,
    approach: Approach = NO_OFFSET,
) -> tuple[Achieved, ...]:
    """Return the worst value of every measure of one force gain.

    Parameters
    ----------
    requirement : Requirement
        Where it is measured, and what is wanted.
    measures : tuple of Measure
        What is measured.
    gain : float
        In rad/(N m).
    approach : Approach
        How the limit is reached, for the steady error; by default there is no offset.
    """
    goals = dict(requirement.goals)
    found = []
    for measure in measures:
        values = {
            corner.label: _force_value(requirement.motion, corner, measure, gain, approach)
            for corner in requirement.corners
            if corner.home or measure is not FORCE_ERROR
        }
        where = (max if measure.upper else min)(values, key=values.__getitem__)
        found.append(Achieved(measure, values[where], where, goals.get(measure)))
    return tuple(found)


def corners_of(
    environments: tuple[Environment, ...],
    home: str,
    gains: Mapping[str, tuple[float, ...]],
    spring: float = 0.0,
) -> tuple[ContactCorner, ...]:
    """List where a controller is measured.

    Parameters
    ----------
    environments : tuple of Environment
        All contacts of the controller.
    home : str
        The one that it is designed for.
    gains : mapping
        Ends of the declared ranges of ``Mt``, ``Bt`` and ``Kt``, empty for a gain without a range.
    spring : float
        The designed Kt, N m/rad.
    """
    return tuple(
        corner
        for environment in environments
        for corner in _corners(environment, home, gains, spring)
    )


def _corners(
    environment: Environment, home: str, gains: Mapping[str, tuple[float, ...]], spring: float
) -> Iterator[ContactCorner]:
    points = list(environment.corners)
    if environment.nominal not in points:
        points.insert(0, environment.nominal)
    designed = (None, None, None)
    retuned = [*product(*(gains.get(name) or (None,) for name in ("Mt", "Bt", "Kt")))]
    for contact, (Mt, Bt, Kt) in product(points, dict.fromkeys([designed, *retuned])):
        at = [*contact.texts()]
        at += [f"Mt = {Mt:.6g} kg*m^2"] if Mt is not None else []
        at += [f"Bt = {Bt:.6g} N*m*s/rad"] if Bt is not None else []
        at += [f"Kt = {Kt:.6g} N*m/rad"] if Kt is not None else []
        is_home = environment.name == home and (Mt, Bt, Kt) == designed
        label = f"{environment.name}, {', '.join(at)}"
        yield ContactCorner(label, contact, is_home, Mt, Bt, spring if Kt is None else Kt)


def _impedance_loops(
    requirement: Requirement, corner: ContactCorner, Mt: FloatArray, Bt: FloatArray
) -> Loops:
    """Return ``G Ze H Y`` of many admittances (thesis fig. 6.13)."""
    loop = ImpedanceLoop(requirement.motion, corner.contact, corner.Kt, requirement.lags)
    contact, free = loop.forward
    numerator = np.zeros((len(Mt), len(free) + 1))
    numerator[:, len(free) + 1 - len(contact) :] = contact
    denominator = np.zeros_like(numerator)
    denominator[:, :-1] += np.outer(Mt, free)
    denominator[:, 1:] += np.outer(Bt, free)
    denominator[:, len(free) + 1 - len(loop.drawn) :] += loop.drawn
    return Loops(numerator, denominator)


def _force_value(
    motion: TransferFunction,
    corner: ContactCorner,
    measure: Measure,
    gain: float,
    approach: Approach,
) -> float:
    """Return a measure of the force loop ``Kp k G`` (thesis 6.33) in one contact."""
    loop_gain = gain * corner.contact.stiffness
    numerator = np.zeros((1, len(motion.denominator)))
    numerator[0, -len(motion.numerator) :] = loop_gain * np.asarray(motion.numerator)
    loops = Loops(numerator, np.array([motion.denominator]))
    if measure is not FORCE_ERROR:
        return float(_margin(loops, measure)[0])
    if not loops.stable[0]:
        return np.inf
    return steady_force_error(motion, corner.contact.stiffness, gain, approach)


def _margin(loops: Loops, measure: Measure) -> FloatArray:
    return {
        SENSITIVITY_PEAK: Loops.sensitivity_peak,
        GAIN_MARGIN: Loops.gain_margin,
        PHASE_MARGIN: Loops.phase_margin,
        DELAY_MARGIN: Loops.delay_margin,
        DISK_MARGIN: Loops.disk_margin,
    }[measure](loops)
