"""The continuous loop of one axis in its surroundings: one linear system for each mode of contact.

The state is that of the motion loop, the position X that the hand has commanded, the reference r
that impedance control adds to it, the states of laws, filter and tissue, and of the command itself:
``v' = s``, ``s' = -omega^2 (v - mean)``, and a constant 1. The motion loop follows the position
``X + r`` of impedance control, or X with the correction of the others, so that a reference may
jump at a switch: with the motor, the state is the angle and ``w = theta' - Km Kd/tau ref``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.laws import CompliantLaw
from nrs_design.errors import DesignError
from nrs_design.models.contact.law import Element
from nrs_design.models.linear_form import coordinates
from nrs_design.models.motion_loop import (
    JointMotionLoop,
    LoadedMotionLoop,
    Realization,
    realize,
)
from nrs_design.models.plant import Plant
from nrs_design.simulation.scenario import COMMAND, DEPTH, TORQUE, Array, Scenario
from nrs_design.simulation.time_response import Signal
from nrs_design.spec import InteractionDesignSpec


@dataclass(frozen=True, slots=True)
class LoopMode:
    """The loop under one controller, in one set of contacts."""

    A: Array  # Shape (n, n), of ``z' = A z``
    # angle, velocity, torque, reference: shape (n,). Rows that give these signals; the torque is
    # that of the contacts on the robot.
    angle: Array
    velocity: Array
    torque: Array
    reference: Array


@dataclass(frozen=True, slots=True)
class MotionStates:
    """The motion loop ``x' = A x + B ref + E F``, with the angle ``C x``; F loads the motor."""

    # A, B, E, C: shapes (n, n), (n,), (n,) and (n,).
    A: Array
    B: Array
    E: Array
    C: Array
    signals: tuple[Signal, ...]  # Names and units of x

    @classmethod
    def build(cls, plant: Plant, design: ControllerDesign) -> MotionStates:
        """Return the loop that the spec states, or the PD controller around the motor."""
        motion: Realization | LoadedMotionLoop
        if plant.given_loop is not None:
            motion = realize(plant.given_loop)
            signals = tuple(Signal(f"motion {i + 1}", "") for i in range(motion.order))
        else:
            motor = plant.actuator.gain, plant.actuator.time_constant
            gains = design.motion.Kp, design.motion.Kd
            motion = JointMotionLoop(*gains, *motor, plant.load_inertia).placed
            signals = Signal("theta", "rad"), Signal("motion w", "rad/s")
        n = motion.order
        reference, load = coordinates(n + 2)[n:]
        rates = np.array(motion.rates(reference, load), float)
        C = np.array(motion.output(n), float)
        return cls(rates[:, :n], rates[:, n], rates[:, n + 1], C, signals)

    def at_rest(self, angle: float) -> Array:
        """Return the state at rest at an angle in rad: 0 = A x + B ref, and C x = ref."""
        rest = np.linalg.solve(self.A, -self.B)
        return np.asarray(rest * angle / float(self.C @ rest))


@dataclass(frozen=True)
class Loop:
    """One axis with its controllers and surfaces."""

    spec: InteractionDesignSpec  # With idle states and offsets
    plant: Plant  # The motor and its load
    design: ControllerDesign  # Gains that ship
    scenario: Scenario  # Surfaces, command and wanted torque

    @cached_property
    def motion(self) -> MotionStates:
        """The motion loop, whose states come first."""
        return MotionStates.build(self.plant, self.design)

    @cached_property
    def laws(self) -> dict[str, CompliantLaw]:
        """The laws by the names of their controllers."""
        return {c.name: c.law for c in self.design.controllers}

    @cached_property
    def states(self) -> tuple[Signal, ...]:
        """Names and units of all states."""
        order = 0 if self.design.sensor.filter is None else self.design.sensor.filter.order
        return (
            *self.motion.signals,
            Signal("commanded position", "rad"),
            Signal("offset", "rad"),
            *self._law_states,
            *(Signal(f"filtered {i + 1}", "N*m") for i in range(order)),
            *(Signal(f"damper {j + 1}", "rad") for j in self._memories),
            Signal("hand", "rad/s"),
            Signal("slope", "rad/s^2"),
            Signal("one", ""),
        )

    @cached_property
    def index(self) -> dict[str, int]:
        """Places of the states by their names."""
        return {signal.name: i for i, signal in enumerate(self.states)}

    @cached_property
    def _law_states(self) -> tuple[Signal, ...]:
        """The states of all laws; laws that name a state alike share it."""
        texts = (text for law in self.laws.values() for text in law.states)
        parted = (text.removesuffix("]").split(" [") for text in texts)
        return tuple(dict.fromkeys(Signal(name, unit) for name, unit in parted))

    @cached_property
    def _bleeding(self) -> tuple[str, ...]:
        """States of laws that stay in the reference while other controllers are active."""
        each = (state_names(law.states) for law in self.laws.values() if law.bleeds)
        return tuple(dict.fromkeys(name for names in each for name in names))

    @cached_property
    def _memories(self) -> tuple[int, ...]:
        """Indices of surfaces with a damper that keeps its deflection."""
        each = enumerate(self.scenario.surfaces)
        return tuple(j for j, s in each if s.element is not None and np.isfinite(s.element.b))

    def row(self, name: str) -> Array:
        """Return the row that gives a state."""
        row: Array = np.eye(len(self.states))[self.index[name]]
        return row

    def _motion_row(self, row: Array) -> Array:
        """Return a row over all states from a row over those of the motion loop."""
        return np.concatenate([row, np.zeros(len(self.states) - len(row))])

    def start(self) -> Array:
        """Return the state at rest at the start, before the first command."""
        z = self._motion_row(self.motion.at_rest(self.scenario.start))
        z[self.index["commanded position"]] = self.scenario.start
        z[self.index["one"]] = 1.0
        return z

    def depth(self, j: int, mode: LoopMode) -> Array:
        """Return the row of the depth below a surface, less what its damper keeps, in rad."""
        surface = self.scenario.surfaces[j]
        row = surface.sign * (mode.angle - surface.at * self.row("one"))
        return row - self.row(f"damper {j + 1}") if j in self._memories else row

    def _element(self, j: int) -> Element:
        """Return the spring and the dampers of a surface; a nonlinear one is refused."""
        surface = self.scenario.surfaces[j]
        if surface.element is None:
            raise DesignError(
                f"{surface.environment} is not linear: the exact engine does not simulate it",
                remedy="use --engine sampled",
                at=("environments", surface.environment),
            )
        return surface.element

    def is_damped(self, j: int) -> bool:
        """Tell whether the push of a surface depends on the velocity of the moment."""
        return self._element(j).c > 0

    def push(self, j: int, mode: LoopMode) -> Array:
        """Return the row of the torque that a surface has while it is touched, towards it."""
        element = self._element(j)
        velocity = self.scenario.surfaces[j].sign * mode.velocity
        return element.k * self.depth(j, mode) + element.c * velocity

    def signal(self, name: str, mode: LoopMode, direction: int) -> Array:
        """Return the row of a signal that the mode logic sees, named as in `Condition`.

        The direction is 1 if the tissue is met by rising angles, -1 if by falling ones.
        """
        if name == COMMAND:
            return direction * self.row("hand")
        if name == TORQUE:
            return direction * mode.torque
        return self.depth(int(name.removeprefix(DEPTH)), mode)

    def mode(self, controller: str, touched: Sequence[int]) -> LoopMode:
        """Return the loop with a controller in force, touching surfaces of some indices."""
        law, motion = self.laws[controller], self.motion
        n, nothing = len(self.states), np.zeros(len(self.states))
        # The angle does not depend on the reference of the moment, the velocity does.
        still = LoopMode(np.zeros((n, n)), self._motion_row(motion.C), nothing, nothing, nothing)
        reference = self.row("commanded position")
        if law.commands == "velocity":
            reference = reference + self.row("offset")
        else:
            if self._takes_at_once(law) and any(map(self.is_damped, touched)):
                raise DesignError(
                    f"{controller} corrects the position by a force that depends on the "
                    "velocity: that is not modelled",
                    remedy="let it touch elastic environments only, filter the force, or use "
                    "--engine sampled",
                    at=("controllers", controller),
                )
            springs = self._law_input(law, self._torque(still, touched))
            reference = reference + self._respond(law, springs)[0]
        if not law.bleeds:
            reference = sum(map(self.row, self._bleeding), reference)
        velocity = self._motion_row(motion.C @ motion.A) + float(motion.C @ motion.B) * reference
        moving = replace(still, velocity=velocity, reference=reference)
        closed = replace(moving, torque=self._torque(moving, touched))
        self._fill(closed, law, touched)
        return closed

    def _takes_at_once(self, law: CompliantLaw) -> bool:
        """Tell whether the command depends on the force of the moment."""
        n = len(self.states)
        none, some = (self._respond(law, np.full(n, force))[0] for force in (0.0, 1.0))
        return self.design.sensor.filter is None and bool((none != some).any())

    def _torque(self, mode: LoopMode, touched: Sequence[int]) -> Array:
        """Return the row of the torque of the contacts on the robot."""
        rows = (self.scenario.surfaces[j].sign * self.push(j, mode) for j in touched)
        return np.asarray(sum(rows, np.zeros(len(self.states))))

    def _law_input(self, law: CompliantLaw, torque: Array) -> Array:
        """Return the row of the force that the law gets."""
        low_pass = self.design.sensor.filter
        force = torque if low_pass is None else self.row(f"filtered {low_pass.order}")
        if law.commands == "velocity":
            return force + float(law.spring) * self.row("offset")
        return force - self.scenario.wanted_torque * self.row("one")

    def _respond(self, law: CompliantLaw, force: Array) -> tuple[Array, list[Array]]:
        """Return the row of the command of a law, and those of the rates of its states."""
        states = [self.row(name).tolist() for name in state_names(law.states)]
        command, rates = law.respond(force.tolist(), states)
        return np.array(command, float), [np.array(rate, float) for rate in rates]

    def _fill(self, mode: LoopMode, law: CompliantLaw, touched: Sequence[int]) -> None:
        """Write the rates of all states into the rows of A."""
        index, A, motion = self.index, mode.A, self.motion
        m = len(motion.C)
        A[:m, :m] = motion.A
        A[:m] += np.outer(motion.B, mode.reference) + np.outer(motion.E, mode.torque)
        low_pass, before = self.design.sensor.filter, mode.torque
        if low_pass is not None:
            for name in (f"filtered {i + 1}" for i in range(low_pass.order)):
                A[index[name]] = float(low_pass.pole) * (before - self.row(name))
                before = self.row(name)
        command, rates = self._respond(law, self._law_input(law, mode.torque))
        idle = self.spec.idle_states
        decay = 0.0 if idle is None else idle.decay.si
        for name in ("offset", *(signal.name for signal in self._law_states)):
            A[index[name]] = -decay * self.row(name)
        for name, rate in zip(state_names(law.states), rates, strict=True):
            A[index[name]] = rate
        if law.commands == "velocity":
            A[index["offset"]] = command
        if not law.holds_hand:
            A[index["commanded position"]] = self.row("hand")
        for j in self._memories:
            element, own = self._element(j), self.row(f"damper {j + 1}")
            pushed = element.k * self.depth(j, mode) if j in touched else 0.0
            A[index[f"damper {j + 1}"]] = (pushed - element.h * own) / element.b
        profile = self.scenario.profile
        A[index["hand"]] = self.row("slope")
        swing = self.row("hand") - profile.mean * self.row("one")
        A[index["slope"]] = -(profile.omega**2) * swing


def state_names(states: Sequence[str]) -> list[str]:
    """Return the names of states of a law, which writes them with their units."""
    return [text.split(" [")[0] for text in states]
