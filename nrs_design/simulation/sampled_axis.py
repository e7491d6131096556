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
from nrs_design.simulation.time_response import Signal, TimeResponse, on_axis
from nrs_design.simulation.tissue import Tissue
from nrs_design.spec.misses import automaton_of
from nrs_design.spec.sampling import SamplingSpec

# Parts of a step with tissue that creeps or loads the motor.
PARTS = 8
# Probability of a miss where the rule allows one.
MISSED = 0.5
# States of the motion loop; all others belong to the outer loop.
_OF_MOTION = frozenset({"error_before"})


class SampleInputs(NamedTuple):
    """Inputs of a sample: command, errors and delays."""

    time: float  # In s
    hand: float  # Commanded velocity in rad/s
    noise: float  # Error of the torque in N m
    age: int  # Age of the force sample
    late: float  # From the sample to its command, in s
    missed: bool  # True for a missed deadline


def draw_samples(
    scenario: Scenario, sampling: SamplingSpec, late: tuple[float, float], count: int
) -> list[SampleInputs]:
    """Draw so many samples from the seed of a scenario.

    `late` holds the times from a sample to its command, in s. Where a rule allows misses, every
    second sample or so is missed.
    """
    rng = np.random.default_rng(scenario.seed)
    step, (youngest, oldest) = float(sampling.step), sampling.delay
    shifted = scenario.errors.jitter * step * rng.random(count)
    noise = scenario.errors.force_noise * rng.standard_normal(count)
    ages = rng.integers(youngest, oldest + 1, count)
    times = step * np.arange(count) + shifted
    lates = late[0] + (late[1] - late[0]) * rng.random(count)
    missed = np.zeros(count, dtype=bool)
    if sampling.misses is not None:
        automaton, state = automaton_of(*sampling.misses.window), 0
        wanted = rng.random(count) < MISSED
        for k in range(count):
            after = automaton.miss[state]
            missed[k] = wanted[k] and after is not None
            state = automaton.hit[state] if after is None or not wanted[k] else after
    columns = (times, scenario.profile.at(times), noise, ages, lates, missed)
    return [
        SampleInputs(*row) for row in zip(*(column.tolist() for column in columns), strict=True)
    ]


@dataclass
class SampledAxis:
    """One axis during a run: law, sensors, motor and tissue."""

    plant: Plant  # Its motor
    design: ControllerDesign  # Gains that ship
    scenario: Scenario  # Command, surfaces and errors
    program: StepProgram  # Its law
    sampling: SamplingSpec  # Period and delay of the law
    # Shortest and longest time from a sample to where its command takes effect, in s.
    late: tuple[float, float]

    def __post_init__(self) -> None:
        """Begin at rest, free of contact."""
        scenario, actuator, law = self.scenario, self.plant.actuator, self.program.law
        gain, tau = float(actuator.gain), float(actuator.time_constant)
        drive = self.plant.drive
        self.motor: Motor | DrivenJoint = Motor(gain, tau, scenario.errors.friction)
        if drive is not None and not drive.loaded:
            self.motor = DrivenJoint.of(drive)
        load = self.plant.load_inertia
        # Command per torque, in units of the command per N m.
        self.load = 0.0 if load is None else tau / (float(load) * gain)
        self.tissue = Tissue(scenario.surfaces)
        self.parts = PARTS if self.load or self.tissue.creeps else 1
        self.theta, self.omega, self.commanded = scenario.start, 0.0, scenario.start
        self.states = [np.float32(scenario.start * s.starts_at_angle) for s in law.states]
        self.inputs = [value.name for value in law.inputs]
        sampling, oldest = self.sampling, self.sampling.delay[1]
        self.T = float(sampling.step)
        # Periods of motion loop and outer loop in samples.
        self.motion_turn = int(sampling.period.exact / sampling.step)
        self.outer_turn = int(sampling.outer / sampling.step)
        self.buffer = deque([0.0] * (oldest + 1), oldest + 1)
        self.modes = {name: i for i, name in enumerate(law.modes)}
        self.holds = {c.name: c.law.holds_hand for c in self.design.controllers}
        self.controller, self.held = scenario.control.start, 0
        # The exported logic compares in single precision, and counts samples.
        self.logic = law.logic if scenario.control.ships else None
        self.schedule = deque(scenario.control.schedule)
        self.switches: list[tuple[float, str]] = []
        self.rows: list[tuple[float, ...]] = []
        self.refused, self.saturated, self.turn, self.command = 0, 0, 0, 0.0
        # The command in force, and those on their way: after how long, the oldest sample first.
        self.in_force, self.sent = 0.0, deque[tuple[float, float]]()
        self.kept = [state.name in _OF_MOTION for state in law.states]
        limit = law.coefficient.get("command_limit")
        self.largest = math.inf if limit is None else float(limit.of(0))

    def run(self, samples: Sequence[SampleInputs], stopped: str | None, tell: Progress) -> Run:
        """Run all samples; `stopped` says why the run ends before its time."""
        ends = [*(sample.time for sample in samples[1:]), samples[-1].time + self.T]
        for k, (sample, end) in enumerate(zip(samples, ends, strict=True)):
            self._take(sample)
            self._move(end - sample.time)
            if k % PROGRESS_STEPS == 0:
                tell(f"{sample.time:.3g} s")
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
        tissue, hand = self.tissue, sample.hand
        torque = tissue.torque(self.theta, self.omega)
        tissue.note(sample.time)
        depths = tissue.depths(self.theta)
        outer = self.turn % self.outer_turn == 0
        if outer:
            read = _coarse(torque + sample.noise, self.scenario.errors.force_step)
            self.buffer.appendleft(read)
        felt, before = self.buffer[sample.age], self.states
        if sample.missed:
            assert self.sampling.misses is not None
            self.command = self.command if self.sampling.misses.command == "hold" else 0.0
        else:
            if outer:
                self._decide(sample.time, hand, felt, depths)
            self._compute(hand, felt, outer=outer)
        self.turn += 1
        now = (self.theta, self.omega, torque, max(0.0, *depths, 0.0), self.command)
        mode = self.modes[self.controller]
        self.rows.append((sample.time, hand, mode, *now, *map(float, before)))
        if not self.holds[self.controller]:
            self.commanded += self.T * hand
        self.sent.append((sample.late, self.command))

    def _compute(self, hand: float, felt: float, *, outer: bool) -> None:
        """Run the law once; states of a loop without a sample now stay."""
        errors, before = self.scenario.errors, self.states
        seen = {
            "angle": _coarse(self.theta, errors.encoder_step),
            "torque": felt,
            # With a position input, the hand moves the position only.
            "velocity_command": 0.0 if "position" in self.inputs else hand,
            "position": self.commanded,
            "wanted_torque": self.scenario.wanted_torque,
        }
        given = [np.float32(seen[name]) for name in self.inputs]
        mode = self.modes[self.controller]
        outputs, after, valid = self.program.step(mode, [*given, *before])
        self.refused += not valid
        motion = self.turn % self.motion_turn == 0
        if motion:
            self.command = float(outputs[0])
            self.saturated += abs(self.command) >= self.largest
        if motion and outer:
            self.states = after
        else:
            each = zip(self.kept, before, after, strict=True)
            self.states = [new if of_motion == motion else old for of_motion, old, new in each]

    def _decide(self, t: float, hand: float, felt: float, depths: list[float]) -> None:
        """Let schedule and mode logic choose the controller."""
        while self.schedule and self.schedule[0][0] <= t:
            self._switch(t, self.schedule.popleft()[1])
        signs = {COMMAND: self.tissue.direction * hand, TORQUE: self.tissue.direction * felt}
        if self.logic is not None:
            seen = {name: float(np.float32(value)) for name, value in signs.items()}
            mode, held = self.logic.step(self.modes[self.controller], self.held, seen)
            self._switch(t, self.program.law.modes[mode])
            self.held = held
            return
        signs |= {f"{DEPTH}{j}": depth for j, depth in enumerate(depths)}
        for switch in self.scenario.control.switches:
            holds = (c.low <= signs[c.signal] <= c.high for c in switch.conditions)
            if switch.source == self.controller and all(holds):
                self._switch(t, switch.target)
                return

    def _switch(self, t: float, target: str) -> None:
        if target != self.controller:
            self.controller = target
            self.switches.append((t, target))

    def _move(self, width: float) -> None:
        """Let motor and tissue move until the next sample, in s, under the commands that come."""
        now = 0.0
        for time, command in self._coming(width):
            self._glide(time - now)
            self.in_force, now = command, time
        self._glide(width - now)

    def _coming(self, width: float) -> list[tuple[float, float]]:
        """Take the commands that take effect within a time; one that a newer overtakes does not."""
        coming: list[tuple[float, float]] = []
        left: deque[tuple[float, float]] = deque()
        soonest = math.inf
        for time, command in reversed(self.sent):
            if time < soonest:
                soonest = time
                if time < width:
                    coming.append((max(time, 0.0), command))
                else:
                    left.appendleft((time - width, command))
        self.sent = left
        # Behind each there are newer and later ones only.
        return coming[::-1]

    def _glide(self, width: float) -> None:
        """Let motor and tissue move for a time in s, under the command in force."""
        tissue, part = self.tissue, width / self.parts
        for _ in range(self.parts):
            drive = self.in_force
            if self.load:
                drive -= self.load * tissue.torque(self.theta, self.omega)
            before = tissue.depths(self.theta)
            self.theta, self.omega = self.motor.after(self.theta, self.omega, drive, part)
            tissue.creep(before, tissue.depths(self.theta), part)

    def _response(self) -> TimeResponse:
        law, first, axis = self.program.law, 3, self.design.axis
        last, rows = first + len(OUTPUTS) + 1, np.array(self.rows, dtype=float).T
        return TimeResponse(
            rows[0],
            rows[first:last],
            rows[last:],
            rows[1:2],
            (*on_axis(OUTPUTS, axis), Signal("command", self.design.command)),
            tuple(Signal(_named(value.name), value.unit) for value in law.states),
            on_axis(INPUTS, axis),
            rows[2].astype(np.int64),
            law.modes,
        )


def _named(state: str) -> str:
    """Return the name of a state of the law; none is that of an output."""
    name = state.replace("_", " ")
    taken = {signal.name for signal in (*OUTPUTS, *INPUTS)} | {"command"}
    return f"state {name}" if name in taken else name


def _coarse(value: float, step: float) -> float:
    """Return the multiple of a step that is nearest; the value itself, where there is no step."""
    return round(value / step) * step if step else value
