"""A scenario in SI numbers: command over time, surfaces, and who is in control when."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from nrs_design.models.contact.law import AbstractNonlinearLaw, Element

Array = NDArray[np.float64]

COMMAND, TORQUE = "command", "torque"
# Before the index of a surface: the depth below it, rad.
DEPTH = "depth of "


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a profile: ``v' = s`` and ``s' = -omega^2 (v - mean)`` from its start on."""

    start: float  # In s
    # value, slope: v in rad/s and s in rad/s^2 at the start.
    value: float
    slope: float


@dataclass(frozen=True, slots=True)
class Profile:
    """The commanded velocity over time: straight lines, or a sinusoid."""

    pieces: tuple[Piece, ...]  # In order; the first starts at zero
    omega: float = 0.0  # Angular frequency in rad/s; zero for straight lines
    mean: float = 0.0  # About which it oscillates, rad/s

    @classmethod
    def constant(cls, velocity: float) -> Profile:
        """Return one velocity in rad/s, all the time."""
        return cls((Piece(0.0, velocity, 0.0),))

    @classmethod
    def sinusoid(cls, amplitude: float, omega: float, mean: float = 0.0) -> Profile:
        """Return ``mean + amplitude sin(omega t)`` in rad/s; omega in rad/s, too."""
        return cls((Piece(0.0, mean, amplitude * omega),), omega, mean)

    @classmethod
    def through(cls, times: Array, velocities: Array) -> Profile:
        """Return straight lines between points, in s and rad/s; the last velocity is kept.

        Times rise from zero; twice the same one is a jump.
        """
        points = zip(times.tolist(), velocities.tolist(), strict=True)
        pieces = [
            Piece(time, value, (further - value) / (end - time))
            for (time, value), (end, further) in pairwise(points)
            if end > time
        ]
        return cls((*pieces, Piece(float(times[-1]), float(velocities[-1]), 0.0)))

    def evaluate(self, time: Array) -> Array:
        """Return the velocity at times in s, after jumps."""
        columns = np.array([(piece.start, piece.value, piece.slope) for piece in self.pieces]).T
        index = np.clip(np.searchsorted(columns[0], time, side="right") - 1, 0, None)
        start, value, slope = columns[:, index]
        elapsed = time - start
        if self.omega == 0:
            return np.asarray(value + slope * elapsed)
        phase = self.omega * elapsed
        swing = (value - self.mean) * np.cos(phase) + slope / self.omega * np.sin(phase)
        return np.asarray(self.mean + swing)


@dataclass(frozen=True, slots=True)
class Surface:
    """Where an environment begins; it pushes and never pulls."""

    environment: str  # Its name
    # At the pivot, at fixed parameters: springs and dampers of a linear law, or a nonlinear one.
    law: Element | AbstractNonlinearLaw
    angle: float  # In rad
    sign: int  # 1 if rising angles lead into it, else -1

    @property
    def element(self) -> Element | None:
        """Springs and dampers of a linear law, which alone the exact engine knows."""
        return self.law if isinstance(self.law, Element) else None


@dataclass(frozen=True, slots=True)
class Condition:
    """A bound on a signal, positive towards the tissue."""

    # ``command`` in rad/s, ``torque`` in N m, or ``depth of INDEX`` in rad, of a surface.
    signal: str
    # low, high: within which it holds.
    low: float = -math.inf
    high: float = math.inf


@dataclass(frozen=True, slots=True)
class Switch:
    """A switch that is made when all its conditions hold."""

    # source, target: controllers.
    source: str
    target: str
    conditions: tuple[Condition, ...]  # At least one


@dataclass(frozen=True, slots=True)
class Control:
    """Who is in control when."""

    start: str  # Controller at first
    switches: tuple[Switch, ...] = ()  # The first that may be made is
    # For how long a timer holds a controller, in s.
    timers: Mapping[str, float] = field(default_factory=dict)
    # Times in s at which a controller takes over, whatever signals say.
    schedule: tuple[tuple[float, str], ...] = ()
    # True for the mode logic of the spec, as in exported programs.
    ships: bool = False


@dataclass(frozen=True, slots=True)
class Errors:
    """What acts on the sampled loop and its sensors."""

    friction: float = 0.0  # Coulomb friction of the motor, in the unit of its commands
    # encoder_step, force_step: resolutions in rad and N m; zero for none.
    encoder_step: float = 0.0
    force_step: float = 0.0
    force_noise: float = 0.0  # Standard deviation in N m
    jitter: float = 0.0  # Largest delay of a sample, as a fraction of the period


@dataclass(frozen=True, slots=True)
class Scenario:
    """One run of the robot against its surroundings, in SI."""

    name: str  # As in the spec
    profile: Profile  # Commanded velocity
    duration: float  # In s
    surfaces: tuple[Surface, ...]  # Environments and their positions; forces add up
    control: Control  # Who is in control when
    start: float = 0.0  # Angle at which the axis rests at first, in rad
    wanted_torque: float = 0.0  # Fd of force controllers in N m, towards rising angles
    errors: Errors = Errors()  # For the sampled engine
    seed: int = 0  # Seed of noise, jitter and varying delay
    # Limits of the run: ``torque`` in N m, ``deflection`` in rad, ``velocity`` in rad/s.
    limits: Mapping[str, float] = field(default_factory=dict)
