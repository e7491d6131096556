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

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.errors import DesignError
from nrs_design.models.motion_loop import realize
from nrs_design.models.plant import Plant
from nrs_design.simulation.scenario import COMMAND, DEPTH, TORQUE, Array, Scenario
from nrs_design.simulation.time_response import Signal
from nrs_design.spec import InteractionDesignSpec


@dataclass(frozen=True, slots=True)
class LoopMode:
    """The loop under one controller, in one set of contacts."""

    A: Array  # Shape (n, n). Of ``z' = A z``.
    # angle, velocity, torque, reference: shape (n,). Rows that give these signals; the torque is
    # that of the contacts on the robot.
    angle: Array
    velocity: Array
    torque: Array
    reference: Array


@dataclass(frozen=True)
class Loop:
    """One axis with its controllers and surfaces; `mode` refuses what is not modelled here."""

    spec: InteractionDesignSpec  # With idle states and offsets
    plant: Plant  # The motor and its load
    design: ControllerDesign  # Gains that ship
    scenario: Scenario  # Surfaces, command and wanted torque

    @cached_property
    def states(self) -> tuple[Signal, ...]:
        """Names and units of all states."""
        if self._given is not None:
            motion = [Signal(f"motion {i + 1}", "") for i in range(self._given[0].shape[0])]
        else:
            motion = [Signal("theta", "rad"), Signal("motion w", "rad/s")]
        order = 0 if self.design.sensor.filter is None else self.design.sensor.filter.order
        return (
            *motion,
            Signal("commanded position", "rad"),
            Signal("offset", "rad"),
            *(Signal(name, unit) for name, unit in self._own),
            *(Signal(f"filtered {i + 1}", "N*m") for i in range(order)),
            *(Signal(f"damper {j + 1}", "rad") for j in self._memories),
            Signal("hand", "rad/s"),
            Signal("slope", "rad/s^2"),
            Signal("one", ""),
        )

    @cached_property
    def _index(self) -> dict[str, int]:
        return {signal.name: i for i, signal in enumerate(self.states)}

    @cached_property
    def _own(self) -> tuple[tuple[str, str], ...]:
        """States of all laws; laws that name a state alike share it."""
        texts = (text for c in self.design.controllers for text in c.law.states)
        parted = (text.removesuffix("]").split(" [") for text in texts)
        return tuple(dict.fromkeys((name, unit) for name, unit in parted))

    @cached_property
    def bleeding(self) -> tuple[str, ...]:
        """States of laws that stay in the reference while other controllers are active."""
        texts = (text for c in self.design.controllers if c.law.bleeds for text in c.law.states)
        return tuple(dict.fromkeys(text.split(" [")[0] for text in texts))

    @cached_property
    def _memories(self) -> tuple[int, ...]:
        """Indices of surfaces with a damper that keeps its deflection."""
        each = enumerate(self.scenario.surfaces)
        return tuple(j for j, s in each if s.element is not None and np.isfinite(s.element.b))

    @cached_property
    def _given(self) -> tuple[Array, Array] | None:
        """A and C of a motion loop that the spec states itself."""
        if self.plant.given_loop is None:
            return None
        realization = realize(self.plant.given_loop)
        return np.array(realization.A, float), np.array(realization.C, float)

    def row(self, name: str) -> Array:
        """Return the row that gives a state."""
        row: Array = np.eye(len(self.states))[self._index[name]]
        return row

    def start(self) -> Array:
        """Return the state at rest at the start, before the first command."""
        z = np.zeros(len(self.states))
        angle = self.scenario.start
        if self._given is None:
            z[0], z[1] = angle, -self._direct * angle
        else:
            A, C = self._given
            # At rest the input is the angle: 0 = A x + B r, and C x = r.
            rest = np.linalg.solve(A, -np.eye(len(C))[-1])
            z[: len(C)] = rest * angle / float(C @ rest)
        z[self._index["commanded position"]] = angle
        z[self._index["one"]] = 1.0
        return z

    @cached_property
    def _direct(self) -> float:
        """By how much the velocity jumps with the reference, 1/s."""
        actuator, motion = self.plant.actuator, self.design.motion
        return float(actuator.gain * motion.Kd / actuator.time_constant)

    def depth(self, j: int, mode: LoopMode) -> Array:
        """Return the row of the depth below a surface, less what its damper keeps, in rad."""
        surface = self.scenario.surfaces[j]
        row = surface.sign * (mode.angle - surface.at * self.row("one"))
        return row - self.row(f"damper {j + 1}") if j in self._memories else row

    def is_damped(self, j: int) -> bool:
        """Tell whether the push of a surface depends on the velocity of the moment."""
        element = self.scenario.surfaces[j].element
        return element is not None and element.c > 0

    def push(self, j: int, mode: LoopMode) -> Array:
        """Return the row of the torque that a surface has while it is touched, towards it."""
        surface = self.scenario.surfaces[j]
        element = surface.element
        if element is None or not surface.is_linear:
            what = "has others beside it" if surface.arms else "is not linear"
            raise DesignError(
                f"{surface.environment} {what}: the exact engine does not simulate it",
                remedy="use --engine sampled",
                at=("environments", surface.environment),
            )
        return element.k * self.depth(j, mode) + element.c * surface.sign * mode.velocity

    def mode(self, controller: str, touched: Sequence[int]) -> LoopMode:
        """Return the loop with a controller in force, touching surfaces of some indices."""
        active = next(c for c in self.design.controllers if c.name == controller)
        return _Closing(self, active, tuple(touched)).mode()

    def signal(self, name: str, mode: LoopMode, direction: int) -> Array:
        """Return the row of a signal that the mode logic sees, named as in `Condition`.

        The direction is 1 if the tissue is met by rising angles, -1 if by falling ones.
        """
        if name == COMMAND:
            return direction * self.row("hand")
        if name == TORQUE:
            return direction * mode.torque
        return self.depth(int(name.removeprefix(DEPTH)), mode)


@dataclass(frozen=True)
class _Closing:
    """A loop that is being closed around one controller."""

    loop: Loop
    controller: Controller
    touched: tuple[int, ...]

    def mode(self) -> LoopMode:
        loop, law = self.loop, self.controller.law
        row, n = loop.row, len(loop.states)
        moves = law.commands == "velocity"
        A = np.zeros((n, n))
        # The angle does not depend on the reference of the moment, the velocity does.
        angle = row("theta") if loop._given is None else _padded(loop._given[1], n)
        still = LoopMode(A, angle, np.zeros(n), np.zeros(n), np.zeros(n))
        springs = self._torque(still)
        if not moves and self._takes_at_once() and any(map(loop.is_damped, self.touched)):
            raise DesignError(
                f"{self.controller.name} corrects the position by a force that depends on the "
                "velocity: that is not modelled",
                remedy="let it touch elastic environments only, filter the force, or use --engine "
                "sampled",
                at=("controllers", self.controller.name),
            )
        reference = row("commanded position")
        if moves:
            reference = reference + row("offset")
        else:
            correction, _ = self._respond(self._felt(springs))
            reference = reference + correction
        if not law.bleeds:
            reference = sum((row(name) for name in loop.bleeding), reference)
        found = LoopMode(A, angle, self._velocity(reference), np.zeros(n), reference)
        torque = self._torque(found)
        self._fill(A, found, torque)
        return replace(found, torque=torque)

    def _takes_at_once(self) -> bool:
        """Tell whether the command depends on the force of the moment."""
        n = len(self.loop.states)
        none, some = (self._respond(np.full(n, force))[0] for force in (0.0, 1.0))
        return self.loop.design.sensor.filter is None and bool((none != some).any())

    def _torque(self, mode: LoopMode) -> Array:
        loop = self.loop
        rows = (loop.scenario.surfaces[j].sign * loop.push(j, mode) for j in self.touched)
        return np.asarray(sum(rows, np.zeros(len(loop.states))))

    def _velocity(self, reference: Array) -> Array:
        loop, n = self.loop, len(self.loop.states)
        if loop._given is None:
            return np.asarray(loop.row("motion w") + loop._direct * reference)
        A, C = loop._given
        return np.asarray(_padded(C @ A, n) + C[-1] * reference)

    def _felt(self, torque: Array) -> Array:
        """Return the row of the force that the law gets."""
        loop, law = self.loop, self.controller.law
        low_pass = loop.design.sensor.filter
        felt = torque if low_pass is None else loop.row(f"filtered {low_pass.order}")
        if law.commands == "velocity":
            return felt + float(law.spring) * loop.row("offset")
        return felt - loop.scenario.wanted_torque * loop.row("one")

    def _respond(self, felt: Array) -> tuple[Array, list[Array]]:
        law = self.controller.law
        states = [self.loop.row(text.split(" [")[0]).tolist() for text in law.states]
        command, rates = law.respond(felt.tolist(), states)
        return np.array(command, float), [np.array(rate, float) for rate in rates]

    def _fill(self, A: Array, mode: LoopMode, torque: Array) -> None:
        """Write the rates of all states into the rows of A."""
        loop, law, index = self.loop, self.controller.law, self.loop._index
        self._fill_motion(A, mode, torque)
        low_pass = loop.design.sensor.filter
        if low_pass is not None:
            before = torque
            for i in range(1, low_pass.order + 1):
                own = loop.row(f"filtered {i}")
                A[index[f"filtered {i}"]] = float(low_pass.pole) * (before - own)
                before = own
        command, rates = self._respond(self._felt(torque))
        idle = loop.spec.idle_states
        decay = 0.0 if idle is None else idle.decay.si
        for name, _ in loop._own:
            A[index[name]] = -decay * loop.row(name)
        for text, rate in zip(law.states, rates, strict=True):
            A[index[text.split(" [")[0]]] = rate
        if law.commands == "velocity":
            A[index["offset"]] = command
        else:
            A[index["offset"]] = -decay * loop.row("offset")
        if not law.holds_hand:
            A[index["commanded position"]] = loop.row("hand")
        self._fill_tissue(A, mode)
        profile = loop.scenario.profile
        A[index["hand"]] = loop.row("slope")
        swing = loop.row("hand") - profile.mean * loop.row("one")
        A[index["slope"]] = -(profile.omega**2) * swing

    def _fill_motion(self, A: Array, mode: LoopMode, torque: Array) -> None:
        loop = self.loop
        if loop._given is not None:
            own, _ = loop._given
            m = len(own)
            A[:m, :m] = own
            A[m - 1] += mode.reference
            return
        actuator, motion = loop.plant.actuator, loop.design.motion
        Km, tau = float(actuator.gain), float(actuator.time_constant)
        error = mode.reference - mode.angle
        pull = Km * float(motion.Kp) * error - (Km * float(motion.Kd) + 1) * mode.velocity
        A[0], A[1] = mode.velocity, pull / tau
        if loop.plant.load_inertia is not None:
            A[1] -= torque / float(loop.plant.load_inertia)

    def _fill_tissue(self, A: Array, mode: LoopMode) -> None:
        loop = self.loop
        for j in loop._memories:
            element = loop.scenario.surfaces[j].element
            assert element is not None
            pushed = element.k * loop.depth(j, mode) if j in self.touched else 0.0
            own = loop.row(f"damper {j + 1}")
            A[loop._index[f"damper {j + 1}"]] = (pushed - element.h * own) / element.b


def _padded(row: Array, size: int) -> Array:
    return np.concatenate([row, np.zeros(size - len(row))])
