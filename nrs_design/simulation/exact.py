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
from nrs_design.simulation.run import INPUTS, LEFT_OUT, MAX_STEPS, OUTPUTS, PROGRESS_STEPS, Run
from nrs_design.simulation.scenario import Array, Errors, Piece, Scenario
from nrs_design.simulation.time_response import Signal, TimeResponse
from nrs_design.spec import InteractionDesignSpec

# Tolerance of guards in rad, N m and rad/s: rounding lets neither contact nor logic chatter.
TOLERANCE = 1e-12
# Points of a run, at least.
POINTS = 2000
# Steps that one event costs.
EVENT_STEPS = 250
# Effects without a model in this engine: always, and if the scenario has errors.
LEFT_OUT_EXACTLY = "sampling, delay and rounding of the law, and the limit of the motor's command"
OMITTED_ERRORS = "friction, resolutions, noise and jitter of the scenario"


def simulate_exactly(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenario: Scenario,
    *,
    max_steps: int = MAX_STEPS,
    progress: Progress = silent,
) -> Run:
    """Simulate a scenario in continuous time, without what acts on the sampled loop alone.

    A run that takes more than `max_steps` ends there, and one with an event in less than
    `EVENT_STEPS` of them. A `DesignError` if a surface is not linear, or a law is not modelled with
    it.
    """
    return _Engine(Loop(spec, plant, design, scenario), max_steps, progress).run()


@dataclass(frozen=True)
class _Location:
    """The loop under one controller in one contact, with the guards that end it."""

    mode: LoopMode  # The loop
    # depths, pushes: shape (surfaces, n). Rows of the depths below surfaces, and of their pushes.
    depths: Array
    pushes: Array
    dampers: tuple[int, ...]  # Indices of the surfaces whose pushes are watched
    conditions: Array  # Shape (bounds, n). Rows that are positive where conditions hold.
    # Switch, condition, and side (0 lower, 1 upper) of each bound.
    bounds: tuple[tuple[int, int, int], ...]
    outputs: Array  # Shape (n, 4). From a state to angle, velocity, torque and reference.
    step: float  # Longest step, in s

    @cached_property
    def flow(self) -> Flow:
        """The flow; it watches depths, pushes of `dampers`, and conditions."""
        rows = np.concatenate([self.depths, self.pushes[[*self.dampers]], self.conditions])
        # At the end of a flow, its signal is beyond the tolerance.
        return Flow(self.mode.A, rows, np.full(len(rows), 2 * TOLERANCE), self.step)


class _Engine:
    """A run of the hybrid loop, up to now."""

    def __init__(self, loop: Loop, max_steps: int, report: Progress) -> None:
        """Begin at rest, free of contact."""
        self.loop, self.max_steps, self.report = loop, max_steps, report
        self.locations: dict[tuple[object, ...], _Location] = {}
        self.switches: list[tuple[float, str]] = []
        self.contacts: list[tuple[float, str, bool]] = []
        self.steps, self.crossings = 0, 0
        self.stopped: str | None = None
        self.surfaces, self.names = loop.scenario.surfaces, tuple(loop.laws)
        self.t, self.z = 0.0, loop.start()
        self.controller, self.since = loop.scenario.control.start, 0.0
        # Sign of the surface that was touched last.
        self.direction = self.surfaces[0].sign if self.surfaces else 1
        # Indices of surfaces with positive depth, and with a tensile contact force.
        self.inside, self.pulling = frozenset[int](), frozenset[int]()
        # Bounds of conditions that hold.
        self.satisfied = frozenset[tuple[int, int, int]]()
        self.location = self._enter()
        # Times, states, outputs and controller of each part of the run.
        self.parts: list[tuple[Array, Array, Array, int]] = []

    def run(self) -> Run:
        """Go from event to event until the end."""
        scenario = self.loop.scenario
        end, dwells, agenda = scenario.duration, scenario.control.timers, self._agenda()
        while self.t < end and self.stopped is None:
            while agenda and agenda[0][0] <= self.t:
                agenda.popleft()[1]()
                self._settle()
            limit = min(end, agenda[0][0]) if agenda else end
            timer = self.since + dwells.get(self.controller, 0.0)
            waits = timer > self.t
            crossed = self._advance(min(limit, timer) if waits else limit)
            self.crossings += crossed
            if crossed or waits:
                self._settle()
            if self.stopped is None and self.crossings > self.max_steps // EVENT_STEPS:
                self.stopped = (
                    f"{self.crossings} events by {self.t:.6g} s: the budget is used up, "
                    f"one event in {EVENT_STEPS} of --max-steps"
                )
        self._record(self.z[None])
        errors = [OMITTED_ERRORS] if scenario.errors != Errors() else []
        return Run(
            scenario.name,
            "exact",
            self._response(),
            tuple(self.switches),
            tuple(self.contacts),
            self.steps,
            stopped=self.stopped,
            left_out=(*LEFT_OUT, LEFT_OUT_EXACTLY, *errors),
        )

    def _agenda(self) -> deque[tuple[float, Callable[[], None]]]:
        """Return breakpoints of the command and scheduled switches, in the order of their times."""
        scenario = self.loop.scenario
        pieces = ((piece.start, partial(self._command, piece)) for piece in scenario.profile.pieces)
        turns = ((time, partial(self._switch, name)) for time, name in scenario.control.schedule)
        return deque(sorted((*pieces, *turns), key=itemgetter(0)))

    def _command(self, piece: Piece) -> None:
        """Begin a part of the command."""
        if self.z[-3] != piece.value:
            self._record(self.z[None])
        self.z = np.array([*self.z[:-3], piece.value, piece.slope, 1.0])

    def _enter(self) -> _Location:
        """Return the location that the loop is in now."""
        key = (self.controller, self.inside, self.pulling, self.direction)
        if key not in self.locations:
            self.locations[key] = self._locate()
        return self.locations[key]

    def _locate(self) -> _Location:
        """Build the location that the loop is in now."""
        loop, one, surfaces = self.loop, self.loop.row("one"), range(len(self.surfaces))
        mode = loop.mode(self.controller, sorted(self.inside - self.pulling))
        rows, bounds = [], []
        for i, switch in enumerate(loop.scenario.control.switches):
            for k, condition in enumerate(switch.conditions):
                if switch.source != self.controller:
                    continue
                signal = loop.signal(condition.signal, mode, self.direction)
                for end, bound, sign in ((0, condition.low, 1), (1, condition.high, -1)):
                    if np.isfinite(bound):
                        rows.append(sign * (signal - bound * one))
                        bounds.append((i, k, end))
        return _Location(
            mode,
            np.array([loop.depth(j) for j in surfaces]).reshape(-1, len(one)),
            np.array([loop.push(j, mode.velocity) for j in surfaces]).reshape(-1, len(one)),
            tuple(sorted(j for j in self.inside if loop.elements[j].c > 0)),
            np.array(rows).reshape(-1, len(one)),
            tuple(bounds),
            np.stack([loop.angle, mode.velocity, mode.torque, mode.reference], axis=1),
            loop.scenario.duration / POINTS,
        )

    def _advance(self, limit: float) -> bool:
        """Follow the flow up to the first event, or to a limit; tell whether there was an event."""
        location, flow = self.location, self.location.flow
        positive = [j in self.inside for j in range(len(self.surfaces))]
        positive += [j not in self.pulling for j in location.dampers]
        positive += [bound in self.satisfied for bound in location.bounds]
        sides = np.where(positive, 1.0, -1.0)
        while self.t < limit and self.stopped is None:
            states = flow.chunk(self.z, min(CHUNK, int((limit - self.t) / flow.h)))
            if count := flow.first_doubtful(states, sides):
                self._record(states[:count], flow.h)
                self.t, self.z = self.t + count * flow.h, states[count]
                self._count(count)
                continue
            width = min(flow.h, limit - self.t)
            time = flow.first_crossing(self.z, width, sides)
            self._record(self.z[None])
            reaches_limit = time is None and width < flow.h
            step = width if time is None else time
            self.t, self.z = limit if reaches_limit else self.t + step, flow.advance(self.z, step)
            self._count(1)
            if time is not None:
                return True
        return False

    def _count(self, steps: int) -> None:
        """Count steps, report progress, and stop a run with too many."""
        self.steps += steps
        if self.steps > self.max_steps:
            self.stopped = f"{self.max_steps} steps by {self.t:.6g} s: the budget is used up"
        if self.steps // PROGRESS_STEPS != (self.steps - steps) // PROGRESS_STEPS:
            self.report(f"{self.t:.3g} s")

    def _settle(self) -> None:
        """Make every change that is due at this instant."""
        for _ in range(4 * (len(self.loop.scenario.control.switches) + len(self.surfaces)) + 4):
            if not (self._change_contact() or self._change_controller()):
                return
        self.stopped = (
            f"the mode logic chatters at {self.t:.6g} s: {self.controller} and others ask for "
            "each other at one instant"
        )

    def _change_contact(self) -> bool:
        """Update contacts; tell whether the location changed."""
        previous, contacts = (self.inside, self.pulling), self.inside - self.pulling
        depths = (self.location.depths @ self.z).tolist()
        pushes = (self.location.pushes @ self.z).tolist()
        self.inside = frozenset(j for j, d in enumerate(depths) if _is_above(d, j in self.inside))
        # Contact begins with a push: outside, none is required.
        self.pulling = frozenset(
            j
            for j in self.inside
            if self.loop.elements[j].c > 0 and not _is_above(pushes[j], j not in self.pulling)
        )
        if (self.inside, self.pulling) == previous:
            return False
        for j in sorted(contacts ^ (self.inside - self.pulling)):
            self.contacts.append((self.t, self.surfaces[j].environment, j not in contacts))
            if j not in contacts:
                self.direction = self.surfaces[j].sign
        self.location = self._enter()
        return True

    def _change_controller(self) -> bool:
        """Make the first switch that is due; tell whether there was one."""
        location, control = self.location, self.loop.scenario.control
        values = zip(location.bounds, (location.conditions @ self.z).tolist(), strict=True)
        self.satisfied = frozenset(b for b, v in values if _is_above(v, b in self.satisfied))
        if self.t < self.since + control.timers.get(self.controller, 0.0):
            return False
        unmet = {bound[0] for bound in location.bounds if bound not in self.satisfied}
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
        mode, spec, index = self.location.mode, self.loop.spec, self.loop.index
        source, sink = self.loop.laws[self.controller], self.loop.laws[target]
        self.z = self.z.copy()
        if spec.offset != "none":
            row = mode.reference if spec.offset == "reference" else self.loop.angle
            self.z[index["commanded position"]] = float(row @ self.z)
        leaves_velocity = source.commands == "velocity" != sink.commands
        if leaves_velocity and spec.idle_states is not None and spec.idle_states.reset:
            for name in (*state_names(source), "offset"):
                self.z[index[name]] = 0.0
        self.controller, self.since, self.satisfied = target, self.t, frozenset()
        self.switches.append((self.t, target))
        self.location = self._enter()

    def _record(self, states: Array, step: float = 0.0) -> None:
        """Keep states from now on, a step apart, with their outputs."""
        times: Array = self.t + step * np.arange(float(len(states)))
        number = self.names.index(self.controller)
        self.parts.append((times, states, states @ self.location.outputs, number))

    def _response(self) -> TimeResponse:
        """Return the records as a table."""
        *columns, numbers = zip(*self.parts, strict=True)
        times, states, rows = map(np.concatenate, columns)
        angle, velocity, torque, reference = rows.T
        # Torques below the tolerance of contact are zero.
        stiffest = max((element.k for element in self.loop.elements), default=0.0)
        torque = np.where(np.abs(torque) <= 4 * TOLERANCE * (1 + stiffest), 0.0, torque)
        depths = [np.zeros_like(angle), *(s.sign * (angle - s.angle) for s in self.surfaces)]
        states = states.T.copy()
        return TimeResponse(
            times,
            np.array([angle, velocity, torque, np.max(depths, axis=0), reference]),
            states[:-3],
            states[-3:-2],
            (*OUTPUTS, Signal("reference", "rad")),
            self.loop.states[:-3],
            INPUTS,
            np.repeat(numbers, [len(part) for part in columns[0]]),
            self.names,
        )


def _is_above(value: float, was_above: bool) -> bool:
    """Tell whether a signal is above zero, or still counts so."""
    return value > -TOLERANCE if was_above else value > TOLERANCE
