"""The exact engine: the continuous switched loop, by matrix exponentials from event to event.

Contact made and lost, conditions of the mode logic, breakpoints of the command, timers and
schedules are events. Between two of them the loop is linear, and `nrs_design.simulation.flow` tells
when the next one comes.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from operator import itemgetter

import numpy as np

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.models.plant import Plant
from nrs_design.progress import Progress, silent
from nrs_design.simulation.flow import CHUNK, Flow
from nrs_design.simulation.loop import Loop, LoopMode, state_names
from nrs_design.simulation.run import (
    ERRORS_LEFT_OUT,
    EVENT_STEPS,
    INPUTS,
    LEFT_OUT,
    LEFT_OUT_EXACTLY,
    MAX_STEPS,
    OUTPUTS,
    PROGRESS_STEPS,
    Run,
)
from nrs_design.simulation.scenario import Array, Errors, Piece, Scenario
from nrs_design.simulation.time_response import Signal, TimeResponse
from nrs_design.spec import InteractionDesignSpec

# Tolerance of guards in rad, N m and rad/s: rounding lets neither contact nor logic chatter.
TOLERANCE = 1e-12
# Points of a run, at least.
POINTS = 2000


def simulate_exactly(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenario: Scenario,
    *,
    max_steps: int = MAX_STEPS,
    tell: Progress = silent,
) -> Run:
    """Simulate a scenario in continuous time, without what acts on the sampled loop alone.

    A run that takes more than `max_steps` ends there, and one with an event in less than
    `EVENT_STEPS` of them. A `DesignError` if a surface is not linear, or a law is not modelled with
    it.
    """
    return _Engine(Loop(spec, plant, design, scenario), max_steps, tell).run()


@dataclass(frozen=True)
class _Location:
    """The loop under one controller in one contact, with the guards that end it."""

    mode: LoopMode  # The loop
    # depths, pushes: shape (surfaces, n). Rows of the depths below surfaces, and of their pushes.
    depths: Array
    pushes: Array
    damped: tuple[int, ...]  # Indices of the surfaces whose pushes are watched
    conditions: Array  # Shape (bounds, n). Rows that are positive where conditions hold.
    # Switch, condition, and side (0 lower, 1 upper) of each bound.
    bounds: tuple[tuple[int, int, int], ...]
    step: float  # Longest step, in s

    @classmethod
    def of(
        cls, loop: Loop, controller: str, inside: list[bool], touched: list[int], direction: int
    ) -> _Location:
        """Return the loop under a controller, with the signals that may end it.

        `inside`: whether the robot is below each surface; `touched`: indices of those that push;
        `direction`: sign of the one that was touched last.
        """
        scenario, mode, one = loop.scenario, loop.mode(controller, touched), loop.row("one")
        each, rows, bounds = range(len(inside)), [], []
        for i, switch in enumerate(scenario.control.switches):
            for k, condition in enumerate(switch.conditions):
                if switch.source != controller:
                    continue
                signal = loop.signal(condition.signal, mode, direction)
                for end, bound, sign in ((0, condition.low, 1), (1, condition.high, -1)):
                    if np.isfinite(bound):
                        rows.append(sign * (signal - bound * one))
                        bounds.append((i, k, end))
        depths, pushes = ([row(j, mode) for j in each] for row in (loop.depth, loop.push))
        damped = tuple(j for j in each if inside[j] and loop.is_damped(j))
        tables = (np.array(table).reshape(-1, len(one)) for table in (depths, pushes, rows))
        depth, push, condition_rows = tables
        step = scenario.duration / POINTS
        return cls(mode, depth, push, damped, condition_rows, tuple(bounds), step)

    @cached_property
    def flow(self) -> Flow:
        """The flow; it watches depths, pushes of `damped` surfaces, and conditions."""
        rows = np.concatenate([self.depths, self.pushes[[*self.damped]], self.conditions])
        # At the end of a flow, its signal is beyond the tolerance.
        return Flow(self.mode.A, rows, np.full(len(rows), 2 * TOLERANCE), self.step)

    @cached_property
    def outputs(self) -> Array:
        """From a state to angle, velocity, torque and reference; shape (n, 4)."""
        mode = self.mode
        return np.stack([mode.angle, mode.velocity, mode.torque, mode.reference], axis=1)


class _Engine:
    """A run of the hybrid loop, up to now."""

    def __init__(self, loop: Loop, max_steps: int, tell: Progress) -> None:
        """Begin at rest, free of contact."""
        self.loop, self.max_steps, self.tell = loop, max_steps, tell
        self.locations: dict[tuple[object, ...], _Location] = {}
        self.switches: list[tuple[float, str]] = []
        self.contacts: list[tuple[float, str, bool]] = []
        self.steps, self.crossings = 0, 0
        self.stopped: str | None = None
        scenario = loop.scenario
        self.t, self.z = 0.0, loop.start()
        self.controller, self.since = scenario.control.start, 0.0
        signs = [surface.sign for surface in scenario.surfaces]
        self.direction = signs[0] if signs else 1
        self.inside = [False] * len(signs)
        self.pushing = [True] * len(signs)
        self.damped = [*map(loop.is_damped, range(len(signs)))]
        self.met: dict[tuple[int, int, int], bool] = {}
        self.names = tuple(loop.laws)
        self.location = self._enter()
        # Times, states, outputs and controller of each part of the run.
        self.kept: list[tuple[Array, Array, Array, int]] = []

    def _touched(self) -> list[int]:
        """Return the indices of the surfaces that push."""
        both = zip(self.inside, self.pushing, strict=True)
        return [j for j, (inside, pushing) in enumerate(both) if inside and pushing]

    def run(self) -> Run:
        """Go from event to event until the end."""
        scenario = self.loop.scenario
        end, stays, agenda = scenario.duration, scenario.control.stays, self._agenda()
        while self.t < end and self.stopped is None:
            while agenda and agenda[0][0] <= self.t:
                agenda.popleft()[1]()
            limit = min(end, agenda[0][0]) if agenda else end
            timer = self.since + stays.get(self.controller, 0.0)
            held = timer > self.t
            crossed = self._advance(min(limit, timer) if held else limit)
            self.crossings += crossed
            if crossed or held:
                self._settle()
            if self.stopped is None and self.crossings > self.max_steps // EVENT_STEPS:
                self.stopped = (
                    f"{self.crossings} events by {self.t:.6g} s: the budget is used up, "
                    f"one event in {EVENT_STEPS} of --max-steps"
                )
        self._record(self.z[None])
        errors = [ERRORS_LEFT_OUT] if scenario.errors != Errors() else []
        return Run(
            scenario.name,
            "exact",
            self._response(),
            tuple(self.switches),
            tuple(self.contacts),
            self.steps,
            stopped=self.stopped,
            left_out=(*LEFT_OUT, *LEFT_OUT_EXACTLY, *errors),
        )

    def _agenda(self) -> deque[tuple[float, Callable[[], None]]]:
        """Return breakpoints of the command and scheduled switches, in the order of their times."""
        scenario = self.loop.scenario
        pieces = ((piece.start, partial(self._command, piece)) for piece in scenario.profile.pieces)
        turns = ((time, partial(self._obey, name)) for time, name in scenario.control.schedule)
        return deque(sorted((*pieces, *turns), key=itemgetter(0)))

    def _obey(self, name: str) -> None:
        """Let the schedule choose the controller."""
        self._switch(name)
        # Without a damper and a logic, contact depends on the angle alone, which is continuous.
        if self.loop.scenario.control.switches or any(self.damped):
            self._settle()

    def _command(self, piece: Piece) -> None:
        """Begin a part of the command."""
        if self.z[-3] != piece.value:
            self._record(self.z[None])
        self.z = np.array([*self.z[:-3], piece.value, piece.slope, 1.0])
        self._settle()

    def _enter(self) -> _Location:
        """Return the location that the loop is in now."""
        key = (self.controller, *self.inside, *self.pushing, self.direction)
        if key not in self.locations:
            self.locations[key] = _Location.of(
                self.loop, self.controller, self.inside, self._touched(), self.direction
            )
        return self.locations[key]

    def _advance(self, limit: float) -> bool:
        """Follow the flow up to the first event, or to a limit; tell whether there was an event."""
        location, flow = self.location, self.location.flow
        pushing = (self.pushing[j] for j in location.damped)
        met = (self.met.get(bound, False) for bound in location.bounds)
        sides = np.where((*self.inside, *pushing, *met), 1.0, -1.0)
        while self.t < limit and self.stopped is None:
            states = flow.chunk(self.z, min(CHUNK, int((limit - self.t) / flow.h)))
            if done := flow.first_doubtful(states, sides):
                self._record(states[:done], flow.h)
                self.t, self.z = self.t + done * flow.h, states[done]
                self._count(done)
                continue
            width = min(flow.h, limit - self.t)
            time = flow.first_crossing(self.z, width, sides)
            self._record(self.z[None])
            at_limit = time is None and width < flow.h
            taken = width if time is None else time
            self.t, self.z = limit if at_limit else self.t + taken, flow.after(self.z, taken)
            self._count(1)
            if time is not None:
                return True
        return False

    def _count(self, done: int) -> None:
        """Count steps, report progress, and stop a run with too many."""
        self.steps += done
        if self.steps > self.max_steps:
            self.stopped = f"{self.max_steps} steps by {self.t:.6g} s: the budget is used up"
        if self.steps // PROGRESS_STEPS != (self.steps - done) // PROGRESS_STEPS:
            self.tell(f"{self.t:.3g} s")

    def _settle(self) -> None:
        """Make every change that is due at this instant."""
        for _ in range(4 * (len(self.loop.scenario.control.switches) + len(self.inside)) + 4):
            if not (self._change_contact() or self._change_controller()):
                return
        self.stopped = (
            f"the mode logic chatters at {self.t:.6g} s: {self.controller} and others ask for "
            "each other at one instant"
        )

    def _change_contact(self) -> bool:
        """Update what is touched; tell whether that changed."""
        before, was = self._touched(), (self.inside, self.pushing)
        depths = (self.location.depths @ self.z).tolist()
        pushes = (self.location.pushes @ self.z).tolist()
        self.inside = [*map(_side, depths, self.inside)]
        # Contact begins with a push: outside, none is required.
        each = zip(self.inside, self.damped, pushes, self.pushing, strict=True)
        self.pushing = [not (within and damped) or _side(*push) for within, damped, *push in each]
        if (self.inside, self.pushing) == was:
            return False
        after = self._touched()
        for j in sorted({*before} ^ {*after}):
            surface = self.loop.scenario.surfaces[j]
            self.contacts.append((self.t, surface.environment, j in after))
            if j in after:
                self.direction = surface.sign
        self.location = self._enter()
        return True

    def _change_controller(self) -> bool:
        """Make the first switch that is due; tell whether there was one."""
        location, control = self.location, self.loop.scenario.control
        values = (location.conditions @ self.z).tolist()
        for bound, value in zip(location.bounds, values, strict=True):
            self.met[bound] = _side(value, self.met.get(bound, False))
        if self.t < self.since + control.stays.get(self.controller, 0.0):
            return False
        unmet = {bound[0] for bound in location.bounds if not self.met[bound]}
        for i, switch in enumerate(control.switches):
            if switch.source == self.controller and i not in unmet:
                self._switch(switch.target)
                return True
        return False

    def _switch(self, target: str) -> None:
        """Let another controller take over, and set what the spec says is set then."""
        self._record(self.z[None])
        if target == self.controller:
            return
        mode, spec, places = self.location.mode, self.loop.spec, self.loop.index
        left, entered = self.loop.laws[self.controller], self.loop.laws[target]
        self.z = self.z.copy()
        if spec.offset != "none":
            taken = mode.reference if spec.offset == "reference" else mode.angle
            self.z[places["commanded position"]] = float(taken @ self.z)
        leaves = left.commands == "velocity" != entered.commands
        if leaves and spec.idle_states is not None and spec.idle_states.reset:
            for name in (*state_names(left.states), "offset"):
                self.z[places[name]] = 0.0
        self.controller, self.since, self.met = target, self.t, {}
        self.switches.append((self.t, target))
        self.location = self._enter()

    def _record(self, states: Array, step: float = 0.0) -> None:
        """Keep states from now on, a step apart, with their outputs."""
        times: Array = self.t + step * np.arange(float(len(states)))
        number = self.names.index(self.controller)
        self.kept.append((times, states, states @ self.location.outputs, number))

    def _response(self) -> TimeResponse:
        """Return what was kept as a table."""
        *columns, numbers = zip(*self.kept, strict=True)
        times, states, rows = map(np.concatenate, columns)
        angle, velocity, torque, reference = rows.T
        surfaces = self.loop.scenario.surfaces
        # Torques below the tolerance of contact are zero.
        stiffest = max((s.element.k for s in surfaces if s.element is not None), default=0.0)
        torque = np.where(np.abs(torque) <= 4 * TOLERANCE * (1 + stiffest), 0.0, torque)
        depths = [s.sign * (angle - s.at) for s in surfaces]
        depth = np.maximum(np.max(depths, axis=0), 0.0) if depths else np.zeros_like(angle)
        states = states.T.copy()
        return TimeResponse(
            times,
            np.array([angle, velocity, torque, depth, reference]),
            states[:-3],
            states[-3:-2],
            (*OUTPUTS, Signal("reference", "rad")),
            self.loop.states[:-3],
            INPUTS,
            np.repeat(numbers, [len(part) for part in columns[0]]),
            self.names,
        )


def _side(value: float, known: bool) -> bool:
    """Tell whether a signal is above zero, or still counts so."""
    return value > -TOLERANCE if known else value > TOLERANCE
