"""The continuous loop of one axis in its surroundings: one linear system for each mode of contact.

The state is that of the motion loop, the position X that the hand has commanded, the reference r
that impedance control adds to it, the states of laws, filter and tissue, and of the command itself:
``v' = s``, ``s' = -omega^2 (v - mean)``, and a constant 1. The motion loop follows the position
``X + r`` of impedance control, or X with the correction of the others, so that a reference may
jump at a switch: with the motor, the state is the angle and ``w = theta' - Km Kd/tau ref``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.laws import CompliantLaw
from nrs_design.errors import DesignError
from nrs_design.models.contact.law import Element
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
    # velocity, torque, reference: shape (n,). Rows that give these signals; the torque is that of
    # the contacts on the robot.
    velocity: Array
    torque: Array
    reference: Array


@dataclass(frozen=True)
class Loop:
    """One axis with its controllers and surfaces."""

    spec: InteractionDesignSpec  # With idle states and offsets
    plant: Plant  # The motor and its load
    design: ControllerDesign  # Gains that ship
    scenario: Scenario  # Surfaces, command and wanted torque

    @cached_property
    def motion(self) -> Realization | LoadedMotionLoop:
        """The loop that the spec states, or the PD controller around the motor."""
        if self.plant.given_loop is not None:
            return realize(self.plant.given_loop)
        actuator, gains = self.plant.actuator, (self.design.motion.Kp, self.design.motion.Kd)
        motor = actuator.gain, actuator.time_constant
        return JointMotionLoop(*gains, *motor, self.plant.load_inertia).position_loop

    @cached_property
    def laws(self) -> dict[str, CompliantLaw]:
        """The laws by the names of their controllers."""
        return {c.name: c.law for c in self.design.controllers}

    @cached_property
    def states(self) -> tuple[Signal, ...]:
        """Names and units of all states; those of the motion loop come first."""
        motion: Sequence[Signal] = (Signal("theta", "rad"), Signal("motion w", "rad/s"))
        if self.plant.given_loop is not None:
            motion = [Signal(f"motion {i + 1}", "") for i in range(self.motion.order)]
        return (
            *motion,
            Signal("commanded position", "rad"),
            Signal("offset", "rad"),
            *self._law_states,
            *(Signal(name, "N*m") for name in self._lags),
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
        pairs = (text.removesuffix("]").split(" [") for text in texts)
        return tuple(dict.fromkeys(Signal(name, unit) for name, unit in pairs))

    @cached_property
    def _lags(self) -> tuple[str, ...]:
        """Names of the states of the force filter; the last is the filtered force."""
        order = 0 if self.design.sensor.filter is None else self.design.sensor.filter.order
        return tuple(f"filtered {i + 1}" for i in range(order))

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """Springs and dampers of every surface; a nonlinear one is refused."""
        for surface in self.scenario.surfaces:
            if surface.element is None:
                raise DesignError(
                    f"{surface.environment} is not linear: the exact engine does not simulate it",
                    remedy="use --engine sampled",
                    at=("environments", surface.environment),
                )
        return tuple(s.element for s in self.scenario.surfaces if s.element is not None)

    @cached_property
    def _memories(self) -> tuple[int, ...]:
        """Indices of surfaces with a damper that keeps its deflection."""
        return tuple(j for j, element in enumerate(self.elements) if np.isfinite(element.b))

    @cached_property
    def angle(self) -> Array:
        """Row of the angle, which does not depend on the reference of the moment."""
        return np.array(self.motion.output(len(self.states)), float)

    def row(self, name: str) -> Array:
        """Return the row that gives a state."""
        row: Array = np.eye(len(self.states))[self.index[name]]
        return row

    def start(self) -> Array:
        """Return the state at rest at the start, before the first command."""
        z, order, index = np.zeros(len(self.states)), self.motion.order, self.index
        A = self.mode(self.scenario.control.start, ()).A
        # The motion loop rests where 0 = A x + B reference, at the angle of the start.
        equilibrium = np.linalg.solve(A[:order, :order], -A[:order, index["commanded position"]])
        z[:order] = equilibrium * self.scenario.start / float(self.angle[:order] @ equilibrium)
        z[index["commanded position"]] = self.scenario.start
        z[index["one"]] = 1.0
        return z

    def depth(self, j: int) -> Array:
        """Return the row of the depth below a surface, less what its damper keeps, in rad."""
        surface = self.scenario.surfaces[j]
        row = surface.sign * (self.angle - surface.angle * self.row("one"))
        return row - self.row(f"damper {j + 1}") if j in self._memories else row

    def push(self, j: int, velocity: Array) -> Array:
        """Return the row of the torque that a surface has while it is touched, towards it."""
        element, sign = self.elements[j], self.scenario.surfaces[j].sign
        return element.k * self.depth(j) + element.c * (sign * velocity)

    def signal(self, name: str, mode: LoopMode, direction: int) -> Array:
        """Return the row of a signal that the mode logic sees, named as in `Condition`.

        The direction is 1 if the tissue is met by rising angles, -1 if by falling ones.
        """
        if name == COMMAND:
            return direction * self.row("hand")
        if name == TORQUE:
            return direction * mode.torque
        return self.depth(int(name.removeprefix(DEPTH)))

    def mode(self, controller: str, contacts: Sequence[int]) -> LoopMode:
        """Return the loop with a controller in force, in contact with surfaces of some indices."""
        law, motion, n = self.laws[controller], self.motion, len(self.states)
        # Dampers push by the velocity, which follows from the reference: it takes springs alone.
        reference = self._reference(law, self._torque(np.zeros(n), contacts))
        velocity = np.array(motion.velocity([*np.zeros(n)], reference.tolist), float)
        torque = self._torque(velocity, contacts)
        if (self._reference(law, torque) != reference).any():
            raise DesignError(
                f"{controller} corrects the position by a force that depends on the "
                "velocity: that is not modelled",
                remedy="let it touch elastic environments only, filter the force, or use "
                "--engine sampled",
                at=("controllers", controller),
            )
        A = np.zeros((n, n))
        A[: motion.order] = np.array(motion.rates(reference.tolist(), torque.tolist()), float)
        for name, rate in self._rates(law, torque, contacts).items():
            A[self.index[name]] = rate
        return LoopMode(A, velocity, torque, reference)

    def _reference(self, law: CompliantLaw, torque: Array) -> Array:
        """Return the row of the position that the motion loop follows."""
        correction = self.row("offset")
        if law.commands != "velocity":
            correction = self._respond(law, torque)[0]
        reference = self.row("commanded position") + correction
        if law.is_leaky:
            return reference
        # States of other laws stay in the reference, and decay there.
        others = (name for one in self.laws.values() if one.is_leaky for name in state_names(one))
        return sum(map(self.row, dict.fromkeys(others)), reference)

    def _torque(self, velocity: Array, contacts: Sequence[int]) -> Array:
        """Return the row of the torque of the contacts on the robot."""
        rows = (self.scenario.surfaces[j].sign * self.push(j, velocity) for j in contacts)
        return np.asarray(sum(rows, np.zeros(len(self.states))))

    def _respond(self, law: CompliantLaw, torque: Array) -> tuple[Array, list[Array]]:
        """Return the row of the command of a law, and those of the rates of its states."""
        force = self.row(self._lags[-1]) if self._lags else torque
        if law.commands == "velocity":
            force = force + float(law.spring) * self.row("offset")
        else:
            force = force - self.scenario.wanted_torque * self.row("one")
        states = [self.row(name).tolist() for name in state_names(law)]
        command, rates = law.respond(force.tolist(), states)
        return np.array(command, float), [np.array(rate, float) for rate in rates]

    def _rates(self, law: CompliantLaw, torque: Array, contacts: Sequence[int]) -> dict[str, Array]:
        """Return the rows of the rates of all states but those of the motion loop, by name."""
        command, rates = self._respond(law, torque)
        idle, low_pass = self.spec.idle_states, self.design.sensor.filter
        decay = 0.0 if idle is None else idle.decay.si
        names = "offset", *(signal.name for signal in self._law_states)
        rows = {name: -decay * self.row(name) for name in names}
        rows |= dict(zip(state_names(law), rates, strict=True))
        if law.commands == "velocity":
            rows["offset"] = command
        if not law.holds_hand:
            rows["commanded position"] = self.row("hand")
        source = torque
        for name in self._lags:
            assert low_pass is not None
            rows[name] = float(low_pass.pole) * (source - self.row(name))
            source = self.row(name)
        for j in self._memories:
            element, damper = self.elements[j], self.row(f"damper {j + 1}")
            load = element.k * self.depth(j) if j in contacts else 0.0
            rows[f"damper {j + 1}"] = (load - element.h * damper) / element.b
        profile = self.scenario.profile
        swing = self.row("hand") - profile.mean * self.row("one")
        return rows | {"hand": self.row("slope"), "slope": -(profile.omega**2) * swing}


def state_names(law: CompliantLaw) -> list[str]:
    """Return the names of the states of a law, which writes them with their units."""
    return [text.split(" [")[0] for text in law.states]
