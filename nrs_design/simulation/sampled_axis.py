"""One axis during a sampled run: the law that ships, in single precision, motor and tissue.

At every sample the law gets the angle, and a torque that may be late, each as coarse and as noisy
as the scenario says; its command is held until the next one. Between two samples the motor follows
exactly: ``tau omega' = Km (u - f sign(omega)) - omega``, with the Coulomb friction f in the unit of
the commands, at rest while ``|u| <= f``. The torque of tissue follows from angle and velocity of
the moment; where it keeps a damper, or the motor carries it, the step is cut into parts.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.replica import StepProgram
from nrs_design.models.plant import Plant
from nrs_design.progress import Progress
from nrs_design.simulation.motor import DrivenJoint, Motor
from nrs_design.simulation.run import INPUTS, OUTPUTS, PROGRESS_STEPS, Run
from nrs_design.simulation.scenario import COMMAND, DEPTH, TORQUE, Scenario
from nrs_design.simulation.time_response import Signal, TimeResponse, convert_units
from nrs_design.simulation.tissue import Tissue
from nrs_design.spec.misses import automaton_of
from nrs_design.spec.sampling import SamplingSpec

# Parts of a step with tissue that creeps or loads the motor.
PARTS = 8
# Probability of a miss where the rule allows one.
MISSED = 0.5
# The only state of the motion loop; all others belong to the outer loop.
_MOTION_STATE = "error_before"


class SampleInputs(NamedTuple):
    """Inputs of a sample: command, errors and delays."""

    time: float  # In s
    hand: float  # Commanded velocity in rad/s
    noise: float  # Error of the torque in N m
    age: int  # Age of the force sample
    delay: float  # From the sample to its command, in s
    missed: bool  # True for a missed deadline


def draw_samples(
    scenario: Scenario, sampling: SamplingSpec, delays: tuple[float, float], count: int
) -> list[SampleInputs]:
    """Draw so many samples from the seed of a scenario.

    `delays`: shortest and longest time from a sample to its command, in s. Where a rule allows
    misses, every second sample or so is missed.
    """
    rng = np.random.default_rng(scenario.seed)
    step, (youngest, oldest) = float(sampling.step), sampling.delay
    shifted = scenario.errors.jitter * step * rng.random(count)
    noise = scenario.errors.force_noise * rng.standard_normal(count)
    ages = rng.integers(youngest, oldest + 1, count)
    times = step * np.arange(count) + shifted
    lates = delays[0] + (delays[1] - delays[0]) * rng.random(count)
    missed = np.zeros(count, dtype=bool)
    if sampling.misses is not None:
        automaton, state = automaton_of(*sampling.misses.window), 0
        attempts = rng.random(count) < MISSED
        for k in range(count):
            successor = automaton.miss[state]
            missed[k] = attempts[k] and successor is not None
            state = automaton.hit[state] if successor is None or not attempts[k] else successor
    columns = (times, scenario.profile.evaluate(times), noise, ages, lates, missed)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return [SampleInputs(*row) for row in rows]


@dataclass
class SampledAxis:
    """One axis during a run: law, sensors, motor and tissue."""

    plant: Plant  # Its motor
    design: ControllerDesign  # Gains that ship
    scenario: Scenario  # Command, surfaces and errors
    program: StepProgram  # Its law
    sampling: SamplingSpec  # Period and delay of the law

    def __post_init__(self) -> None:
        """Begin at rest, free of contact."""
        scenario, actuator, law = self.scenario, self.plant.actuator, self.program.law
        gain, tau = float(actuator.gain), float(actuator.time_constant)
        drive, load, sampling = self.plant.drive, self.plant.load_inertia, self.sampling
        self.motor: Motor | DrivenJoint = Motor(gain, tau, scenario.errors.friction)
        if drive is not None and not drive.loaded:
            self.motor = DrivenJoint.create(drive)
        # Command per torque, in units of the command per N m.
        self.load = 0.0 if load is None else tau / (float(load) * gain)
        self.tissue = Tissue(scenario.surfaces)
        self.parts = PARTS if self.load or self.tissue.creeps else 1
        self.theta, self.omega, self.commanded = scenario.start, 0.0, scenario.start
        self.states = [np.float32(scenario.start * s.starts_at_angle) for s in law.states]
        self.inputs = [value.name for value in law.inputs]
        self.T = float(sampling.step)
        # Periods of motion loop and outer loop in samples.
        self.motion_turn = int(sampling.period.exact / sampling.step)
        self.outer_turn = int(sampling.outer / sampling.step)
        self.buffer = deque([0.0] * (sampling.delay[1] + 1), sampling.delay[1] + 1)
        self.modes = {name: i for i, name in enumerate(law.modes)}
        # Whether the hand waits while a controller is active.
        self.waits = {c.name: c.law.holds_hand for c in self.design.controllers}
        self.controller, self.samples_in_mode = scenario.control.start, 0
        self.logic = law.logic if scenario.control.ships else None
        self.schedule = deque(scenario.control.schedule)
        self.switches: list[tuple[float, str]] = []
        self.rows: list[tuple[float, ...]] = []
        self.refused, self.saturated, self.turn, self.command = 0, 0, 0, 0.0
        # The command in force, and the later ones: after how long, the oldest sample first.
        self.in_force, self.pending = 0.0, deque[tuple[float, float]]()
        limit = law.coefficient.get("command_limit")
        self.largest = math.inf if limit is None else float(limit.number(0))

    def run(self, samples: Sequence[SampleInputs], stopped: str | None, report: Progress) -> Run:
        """Run all samples; `stopped` says why the run ends before its time."""
        ends = [*(sample.time for sample in samples[1:]), samples[-1].time + self.T]
        for k, (sample, end) in enumerate(zip(samples, ends, strict=True)):
            self._take(sample)
            self._move(end - sample.time)
            if k % PROGRESS_STEPS == 0:
                report(f"{sample.time:.3g} s")
        return Run(
            self.scenario.name,
            "sampled",
            self._response(),
            tuple(self.switches),
            tuple(self.tissue.contacts),
            len(self.rows),
            (float(self.sampling.period.exact), *self.sampling.delay),
            self.refused,
            self.saturated,
            stopped,
            outer=float(self.sampling.outer),
            missed=sum(s.missed for s in samples) if self.sampling.misses else None,
        )

    def _take(self, sample: SampleInputs) -> None:
        """Run the law once; where the deadline is missed, its command is held or zero instead."""
        torque = self.tissue.sample(sample.time, self.theta, self.omega)
        depths, states = self.tissue.depths(self.theta), self.states
        outer = self.turn % self.outer_turn == 0
        if outer:
            reading = _coarse(torque + sample.noise, self.scenario.errors.force_step)
            self.buffer.appendleft(reading)
        force = self.buffer[sample.age]
        if sample.missed:
            assert self.sampling.misses is not None
            self.command = self.command if self.sampling.misses.command == "hold" else 0.0
        else:
            if outer:
                self._decide(sample.time, sample.hand, force, depths)
            self._compute(sample.hand, force, outer=outer)
        self.turn += 1
        outputs = (self.theta, self.omega, torque, max(0.0, *depths, 0.0), self.command)
        mode = self.modes[self.controller]
        self.rows.append((sample.time, sample.hand, mode, *outputs, *map(float, states)))
        if not self.waits[self.controller]:
            self.commanded += self.T * sample.hand
        # A newer command overtakes those that would take effect later.
        while self.pending and self.pending[-1][0] >= sample.delay:
            self.pending.pop()
        self.pending.append((sample.delay, self.command))

    def _compute(self, hand: float, force: float, *, outer: bool) -> None:
        """Run the law once; states of a loop without a sample now stay."""
        signals = {
            "angle": _coarse(self.theta, self.scenario.errors.encoder_step),
            "torque": force,
            # With a position input, the hand moves the position only.
            "velocity_command": 0.0 if "position" in self.inputs else hand,
            "position": self.commanded,
            "wanted_torque": self.scenario.wanted_torque,
        }
        inputs = [np.float32(signals[name]) for name in self.inputs]
        mode, motion = self.modes[self.controller], self.turn % self.motion_turn == 0
        outputs, successors, valid = self.program.step(mode, [*inputs, *self.states])
        self.refused += not valid
        if motion:
            self.command = float(outputs[0])
            self.saturated += abs(self.command) >= self.largest
        triples = zip(self.program.law.states, self.states, successors, strict=True)
        self.states = [
            new if (motion if state.name == _MOTION_STATE else outer) else old
            for state, old, new in triples
        ]

    def _decide(self, t: float, hand: float, force: float, depths: list[float]) -> None:
        """Let schedule and mode logic choose the controller."""
        while self.schedule and self.schedule[0][0] <= t:
            self._switch(t, self.schedule.popleft()[1])
        signals = {COMMAND: self.tissue.direction * hand, TORQUE: self.tissue.direction * force}
        if self.logic is not None:
            float32_signals = {name: float(np.float32(value)) for name, value in signals.items()}
            mode = self.modes[self.controller]
            mode, self.samples_in_mode = self.logic.step(
                mode, self.samples_in_mode, float32_signals
            )
            self._switch(t, self.program.law.modes[mode])
            return
        signals |= {f"{DEPTH}{j}": depth for j, depth in enumerate(depths)}
        for switch in self.scenario.control.switches:
            conditions = (c.low <= signals[c.signal] <= c.high for c in switch.conditions)
            if switch.source == self.controller and all(conditions):
                self._switch(t, switch.target)
                return

    def _switch(self, t: float, target: str) -> None:
        if target != self.controller:
            self.controller = target
            self.switches.append((t, target))

    def _move(self, width: float) -> None:
        """Let motor and tissue move until the next sample, in s, under the commands that come."""
        now = 0.0
        while self.pending and self.pending[0][0] < width:
            time, command = self.pending.popleft()
            self._glide(max(time, 0.0) - now)
            self.in_force, now = command, max(time, 0.0)
        self._glide(width - now)
        self.pending = deque((time - width, command) for time, command in self.pending)

    def _glide(self, width: float) -> None:
        """Let motor and tissue move for a time in s, under the command in force."""
        tissue, part = self.tissue, width / self.parts
        for _ in range(self.parts):
            drive = self.in_force
            if self.load:
                drive -= self.load * tissue.torque(self.theta, self.omega)
            depths = tissue.depths(self.theta)
            self.theta, self.omega = self.motor.advance(self.theta, self.omega, drive, part)
            tissue.creep(depths, tissue.depths(self.theta), part)

    def _response(self) -> TimeResponse:
        law, first, axis = self.program.law, 3, self.design.axis
        last, rows = first + len(OUTPUTS) + 1, np.array(self.rows, dtype=float).T
        return TimeResponse(
            rows[0],
            rows[first:last],
            rows[last:],
            rows[1:2],
            (*convert_units(OUTPUTS, axis), Signal("command", self.design.command)),
            tuple(Signal(_column_name(value.name), value.unit) for value in law.states),
            convert_units(INPUTS, axis),
            rows[2].astype(np.int64),
            law.modes,
        )


def _column_name(state: str) -> str:
    """Return the name of a state of the law; none is that of an output."""
    name = state.replace("_", " ")
    outputs = {signal.name for signal in (*OUTPUTS, *INPUTS)} | {"command"}
    return f"state {name}" if name in outputs else name


def _coarse(value: float, step: float) -> float:
    """Return the multiple of a step that is nearest; the value itself, where there is no step."""
    return round(value / step) * step if step else value
