"""The sampled engine: the law that ships, in single precision, against motor and tissue.

At every sample the law gets the angle, and a torque that may be late, each as coarse and as noisy
as the scenario says; its command is held until the next one. Between two samples the motor follows
exactly: ``tau omega' = Km (u - f sign(omega)) - omega``, with the Coulomb friction f in the unit of
the commands, at rest while ``|u| <= f``. The torque of tissue follows from angle and velocity of
the moment; where it keeps a damper, or the motor carries it, the step is cut into parts.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.shipped import shipped_law
from nrs_design.errors import DesignError
from nrs_design.models.plant import Plant
from nrs_design.simulation.motor import Motor
from nrs_design.simulation.run import MAX_STEPS, Run
from nrs_design.simulation.scenario import (
    COMMAND,
    DEPTH,
    TORQUE,
    Array,
    Condition,
    Scenario,
)
from nrs_design.simulation.step_program import StepProgram
from nrs_design.simulation.time_response import Signal, TimeResponse
from nrs_design.simulation.tissue import Tissue
from nrs_design.spec import InteractionDesignSpec

# Parts of a step, where tissue moves by itself or loads the motor.
PARTS = 8
# Samples after which it is told how far the run is.
_OFTEN = 20_000
Tell = Callable[[str], None]
_OUTPUTS = (
    Signal("angle", "rad"),
    Signal("velocity", "rad/s"),
    Signal("torque", "N*m"),
    Signal("depth", "rad"),
)
_INPUTS = (Signal("hand", "rad/s"),)


def _silent(step: str) -> None:
    """Report no progress."""


def simulate_sampled(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenario: Scenario,
    *,
    max_steps: int = MAX_STEPS,
    tell: Tell = _silent,
) -> Run:
    """Simulate a scenario as the processor runs it.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With its sampling.
    plant : Plant
        Of that spec; its nominal motor.
    design : ControllerDesign
        Gains that ship.
    scenario : Scenario
        What happens, with noise, jitter and delay from its seed.
    max_steps : int
        A run that takes more samples ends there.
    tell : callable
        Told how far the run is.

    Raises
    ------
    DesignError
        If the spec has no sampling or two periods, states the motion loop itself, or there is no
        program of a controller.
    """
    if spec.sampling is None:
        raise DesignError(
            "the spec does not say how often the law runs",
            remedy="add `sampling: {period: 2 ms, delay: 0}`",
        )
    if plant.given_loop is not None:
        raise DesignError(
            "the spec states the motion loop itself, so there is no motor to simulate",
            remedy="leave transfer_function out, or use --engine exact",
            at=("motion_loop", "transfer_function"),
        )
    period = spec.sampling.period.exact
    if spec.sampling.outer != period:
        raise DesignError(
            "the outer loop has a period of its own, and the simulated processor has one for all",
            remedy="leave outer_period out, or use --engine exact",
            at=("sampling", "outer_period"),
        )
    try:
        program = StepProgram(shipped_law(spec, design, period))
    except DesignError as error:
        raise DesignError(error.message, remedy="use --engine exact", at=error.at) from None
    engine = _Engine(plant, design, scenario, program, period, spec.sampling.delay)
    return engine.run(max_steps, tell)


@dataclass(frozen=True, slots=True)
class _Fate:
    """What chance and the surgeon bring, for every sample.

    Parameters
    ----------
    times, hand, noise : ndarray, shape (N,)
        Instants in s, commanded velocities in rad/s, errors of the torque in N m.
    ages : ndarray of int, shape (N,)
        Of the force samples.
    """

    times: Array
    hand: Array
    noise: Array
    ages: NDArray[np.int64]

    @classmethod
    def of(cls, scenario: Scenario, period: float, delay: tuple[int, int], count: int) -> _Fate:
        """Draw it from the seed of the scenario."""
        rng = np.random.default_rng(scenario.seed)
        late = scenario.errors.jitter * period * rng.random(count)
        noise = scenario.errors.force_noise * rng.standard_normal(count)
        ages = rng.integers(delay[0], delay[1] + 1, count)
        times = period * np.arange(count) + late
        return cls(times, scenario.profile.at(times), noise, ages)


@dataclass
class _Engine:
    """A run that is under way."""

    plant: Plant
    design: ControllerDesign
    scenario: Scenario
    program: StepProgram
    period: Fraction
    delay: tuple[int, int]

    def __post_init__(self) -> None:
        """Begin at rest, free of contact."""
        scenario, actuator, law = self.scenario, self.plant.actuator, self.program.law
        gain, tau = float(actuator.gain), float(actuator.time_constant)
        self.motor = Motor(gain, tau, scenario.errors.friction)
        load = self.plant.load_inertia
        # By how much a torque weighs as a command, per N m.
        self.load = 0.0 if load is None else tau / (float(load) * gain)
        self.tissue = Tissue(scenario.surfaces)
        self.parts = PARTS if self.load or self.tissue.creeps else 1
        self.theta, self.omega, self.commanded = scenario.start, 0.0, scenario.start
        self.states = [np.float32(scenario.start * s.starts_at_angle) for s in law.states]
        self.inputs = [value.name for value in law.inputs]
        self.T = float(self.period)
        self.buffer = deque([0.0] * (self.delay[1] + 1), self.delay[1] + 1)
        self.modes = {name: i for i, name in enumerate(law.modes)}
        self.holds = {c.name: c.law.holds_hand for c in self.design.controllers}
        self.rules = {name: self._rules(name) for name in law.modes}
        self.controller, self.held = scenario.control.start, 0
        # What ships compares in single precision, and counts samples.
        self.logic = law.logic if scenario.control.ships else None
        self.schedule = deque(scenario.control.schedule)
        self.switches: list[tuple[float, str]] = []
        self.rows: list[tuple[float, ...]] = []
        self.refused, self.saturated = 0, 0
        limit = law.coefficient.get("command_limit")
        self.largest = math.inf if limit is None else float(limit.of(0))

    def _rules(self, source: str) -> list[tuple[str, tuple[tuple[str, int, float, float], ...]]]:
        """Return the switches from a controller: the target, and bounds on signals."""
        return [
            (switch.target, tuple(_bounds(c) for c in switch.conditions))
            for switch in self.scenario.control.switches
            if switch.source == source
        ]

    def run(self, max_steps: int, tell: Tell) -> Run:
        """Go from sample to sample until the end."""
        T = self.T
        wanted = math.floor(self.scenario.duration / T + 1e-9) + 1
        count = min(wanted, max_steps)
        fate = _Fate.of(self.scenario, T, self.delay, count)
        instants = [*fate.times.tolist(), float(fate.times[-1]) + T]
        rows = zip(fate.hand.tolist(), fate.noise.tolist(), fate.ages.tolist(), strict=True)
        t = 0.0
        for k, (hand, noise, age) in enumerate(rows):
            t = instants[k]
            command = self._sample(t, hand, noise, age)
            self._move(command, instants[k + 1] - t)
            if k % _OFTEN == 0:
                tell(f"{t:.3g} s")
        stopped = None
        if count < wanted:
            stopped = f"{max_steps} samples by {t:.6g} s: the budget is used up"
        return Run(
            self.scenario.name,
            "sampled",
            self._response(fate),
            tuple(self.switches),
            tuple(self.tissue.contacts),
            count,
            (T, *self.delay),
            self.refused,
            self.saturated,
            stopped,
        )

    def _sample(self, t: float, hand: float, noise: float, age: int) -> float:
        """Run the law once; return its command."""
        tissue, errors = self.tissue, self.scenario.errors
        torque = tissue.torque(self.theta, self.omega)
        tissue.note(t)
        depths = tissue.depths(self.theta)
        self.buffer.appendleft(_coarse(torque + noise, errors.force_step))
        felt = self.buffer[age]
        self._decide(t, hand, felt, depths)
        seen = {
            "angle": _coarse(self.theta, errors.encoder_step),
            "torque": felt,
            "velocity_command": hand,
            "position": self.commanded,
            "wanted_torque": self.scenario.wanted_torque,
        }
        mode, before = self.modes[self.controller], self.states
        given = [np.float32(seen[name]) for name in self.inputs]
        outputs, self.states, valid = self.program.step(mode, [*given, *before])
        self.refused += not valid
        command = float(outputs[0])
        self.saturated += abs(command) >= self.largest
        outer = (self.theta, self.omega, torque, max(0.0, *depths, 0.0), command)
        self.rows.append((mode, *outer, *map(float, before)))
        if not self.holds[self.controller]:
            self.commanded += self.T * hand
        return command

    def _decide(self, t: float, hand: float, felt: float, depths: list[float]) -> None:
        """Let schedule and mode logic choose, by what they see at this sample."""
        while self.schedule and self.schedule[0][0] <= t:
            self._switch(t, self.schedule.popleft()[1])
        signs = {COMMAND: self.tissue.direction * hand, TORQUE: self.tissue.direction * felt}
        if self.logic is not None:
            seen = {name: float(np.float32(value)) for name, value in signs.items()}
            mode, held = self.logic.step(self.modes[self.controller], self.held, seen)
            self._switch(t, self.program.law.modes[mode])
            self.held = held
            return
        for target, bounds in self.rules[self.controller]:
            for signal, j, low, high in bounds:
                if not low <= (depths[j] if signal == DEPTH else signs[signal]) <= high:
                    break
            else:
                self._switch(t, target)
                return

    def _switch(self, t: float, target: str) -> None:
        if target != self.controller:
            self.controller = target
            self.switches.append((t, target))

    def _move(self, command: float, width: float) -> None:
        """Let motor and tissue move until the next sample."""
        if self.parts == 1:
            self.theta, self.omega = self.motor.after(self.theta, self.omega, command, width)
            return
        part = width / self.parts
        for _ in range(self.parts):
            drive = command - self.load * self.tissue.torque(self.theta, self.omega)
            before = self.tissue.depths(self.theta)
            self.theta, self.omega = self.motor.after(self.theta, self.omega, drive, part)
            self.tissue.creep(before, self.tissue.depths(self.theta), part)

    def _response(self, fate: _Fate) -> TimeResponse:
        law, last = self.program.law, len(_OUTPUTS) + 2
        rows = np.array(self.rows, dtype=float).T
        return TimeResponse(
            fate.times,
            rows[1:last],
            rows[last:],
            fate.hand[None, :],
            (*_OUTPUTS, Signal("command", self.design.command)),
            tuple(Signal(_named(value.name), value.unit) for value in law.states),
            _INPUTS,
            rows[0].astype(np.int64),
            law.modes,
        )


def _named(state: str) -> str:
    """Return the name of a state of the law; none is that of an output."""
    name = state.replace("_", " ")
    taken = {signal.name for signal in (*_OUTPUTS, *_INPUTS)} | {"command"}
    return f"state {name}" if name in taken else name


def _bounds(condition: Condition) -> tuple[str, int, float, float]:
    """Return signal, index of the surface (of a depth), and both bounds of a condition."""
    if condition.signal.startswith(DEPTH):
        return DEPTH, int(condition.signal.removeprefix(DEPTH)), condition.low, condition.high
    return condition.signal, 0, condition.low, condition.high


def _coarse(value: float, step: float) -> float:
    """Return the multiple of a step that is nearest; the value itself, where there is no step."""
    return round(value / step) * step if step else value
