"""The exact engine: the continuous switched loop, by matrix exponentials from event to event.

Contact made and lost, conditions of the mode logic, breakpoints of the command, timers and
schedules are events. Between two of them the loop is linear, and `nrs_design.simulation.flow` tells
when the next one comes.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import numpy as np

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.models.plant import Plant
from nrs_design.progress import Progress, silent
from nrs_design.simulation.flow import CHUNK
from nrs_design.simulation.location import TOLERANCE, Location
from nrs_design.simulation.loop import Loop, state_names
from nrs_design.simulation.run import (
    ERRORS_LEFT_OUT,
    EVENT_STEPS,
    INPUTS,
    LEFT_OUT,
    LEFT_OUT_EXACTLY,
    MAX_EVENTS,
    MAX_STEPS,
    OUTPUTS,
    Run,
)
from nrs_design.simulation.scenario import Array, Errors, Scenario
from nrs_design.simulation.time_response import Signal, TimeResponse
from nrs_design.spec import InteractionDesignSpec

# Steps between two progress reports.
_OFTEN = 20_000
# Largest number of events at one instant.
_STILL = 100


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


class _Engine:
    """A run of the hybrid loop, up to now."""

    def __init__(self, loop: Loop, max_steps: int, tell: Progress) -> None:
        """Begin at rest, free of contact."""
        self.loop, self.max_steps, self.tell = loop, max_steps, tell
        self.locations: dict[tuple[object, ...], Location] = {}
        self.switches: list[tuple[float, str]] = []
        self.contacts: list[tuple[float, str, bool]] = []
        self.steps, self.crossings = 0, 0
        self.stopped: str | None = None
        scenario = self.loop.scenario
        self.t, self.z = 0.0, self.loop.start()
        self.controller, self.since = scenario.control.start, 0.0
        signs = [surface.sign for surface in scenario.surfaces]
        self.direction = signs[0] if signs else 1
        self.inside = [False] * len(signs)
        self.pushing = [True] * len(signs)
        self.laws = {c.name: c.law for c in self.loop.design.controllers}
        self.damped = any(map(self.loop.is_damped, range(len(signs))))
        self.met: dict[tuple[int, int, int], bool] = {}
        self.location = self._enter()
        # Time of the first state, step, location, and states of each part of the run.
        self.kept: list[tuple[float, float, int, Array]] = []

    def _in_contact(self) -> tuple[int, ...]:
        """Return the indices of the surfaces that push."""
        both = zip(self.inside, self.pushing, strict=True)
        return tuple(j for j, (inside, pushing) in enumerate(both) if inside and pushing)

    def run(self) -> Run:
        """Go from event to event until the end."""
        end = self.loop.scenario.duration
        stays = self.loop.scenario.control.stays
        agenda = deque(sorted(self._agenda()))
        still = 0
        while self.t < end and self.stopped is None:
            before = self.t
            while agenda and agenda[0][0] <= self.t:
                self._happen(*agenda.popleft()[1:])
            limit = min(end, agenda[0][0]) if agenda else end
            timer = self.since + stays.get(self.controller, 0.0)
            held = timer > self.t
            crossed = self._advance(min(limit, timer) if held else limit)
            self.crossings += crossed
            if crossed or held:
                self._settle()
            still = still + 1 if self.t == before else 0
            self._check(still)
        self._record(self.z[None])
        errors = [ERRORS_LEFT_OUT] if self.loop.scenario.errors != Errors() else []
        events = tuple(self.switches), tuple(self.contacts)
        left_out = (*LEFT_OUT, *LEFT_OUT_EXACTLY, *errors)
        name, response = self.loop.scenario.name, self._response()
        return Run(
            name, "exact", response, *events, self.steps, stopped=self.stopped, left_out=left_out
        )

    def _check(self, still: int) -> None:
        """Stop a run that does not come on."""
        events = len(self.switches) + len(self.contacts)
        if self.stopped is None and (events > MAX_EVENTS or still > _STILL):
            self.stopped = (
                f"{events} switches and contacts by {self.t:.6g} s: contact or mode logic chatters"
            )
        elif self.stopped is None and self.crossings > self.max_steps // EVENT_STEPS:
            self.stopped = (
                f"{self.crossings} events by {self.t:.6g} s: the budget is used up, "
                f"one event in {EVENT_STEPS} of --max-steps"
            )

    def _agenda(self) -> Iterator[tuple[float, int, str | int]]:
        """Yield breakpoints of the command and scheduled switches, with their times."""
        scenario = self.loop.scenario
        for i, piece in enumerate(scenario.profile.pieces):
            yield piece.start, 0, i
        for time, name in scenario.control.schedule:
            yield time, 1, name

    def _happen(self, kind: int, what: str | int) -> None:
        if kind == 1:
            self._record(self.z[None])
            self._switch(str(what))
            if not self.loop.scenario.control.switches and not self.damped:
                # Contact depends on the angle alone, which is continuous.
                return
        else:
            piece = self.loop.scenario.profile.pieces[int(what)]
            if self.z[-3] != piece.value:
                self._record(self.z[None])
            self.z = self.z.copy()
            self.z[-3:-1] = piece.value, piece.slope
        self._settle()

    def _enter(self) -> Location:
        """Return the location that the loop is in now."""
        key = (self.controller, *self.inside, *self.pushing, self.direction)
        if key not in self.locations:
            touched, count = self._in_contact(), len(self.locations)
            self.locations[key] = Location.enter(
                self.loop, self.controller, self.inside, touched, self.direction, count
            )
        return self.locations[key]

    def _sides(self, location: Location) -> Array:
        """Return on which side every guard counts as being."""
        flags = (
            *self.inside,
            *(self.pushing[j] for j in location.damped),
            *(self.met.get(bound, False) for bound in location.bounds),
        )
        return np.where(flags, 1.0, -1.0)

    def _advance(self, limit: float) -> bool:
        """Follow the flow up to the first event, or to a limit; tell whether there was an event."""
        flow = self.location.flow
        sides = self._sides(self.location)
        while self.t < limit and self.stopped is None:
            whole = min(CHUNK, int((limit - self.t) / flow.h))
            states = flow.chunk(self.z, whole)
            # The last step may be shorter than the others.
            count = flow.first_doubtful(states, sides)
            done = min(count, whole)
            full = done and count > whole and self.t + (done + 1) * flow.h <= limit
            # The first state of a shorter step is recorded here.
            kept = done if full else done + 1
            self._record(states[:kept], flow.h)
            if done:
                self.t, self.z, self.steps = self.t + done * flow.h, states[done], self.steps + done
                self._tell(done)
            if full:
                continue
            width = min(flow.h, limit - self.t)
            if width <= 0:
                return False
            time = flow.first_crossing(self.z, width, sides) if count <= whole else None
            at_limit = time is None and width < flow.h
            taken = width if time is None else time
            self.t, self.z = limit if at_limit else self.t + taken, flow.after(self.z, taken)
            self.steps += 1
            self._tell(1)
            if time is not None:
                return True
        return False

    def _tell(self, done: int) -> None:
        """Report progress, and stop a run with too many steps."""
        if self.steps > self.max_steps:
            self.stopped = f"{self.max_steps} steps by {self.t:.6g} s: the budget is used up"
        if self.steps // _OFTEN != (self.steps - done) // _OFTEN:
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
        location, before = self.location, self._in_contact()
        was = (list(self.inside), list(self.pushing))
        depths = (location.flow.signals @ self.z).tolist()
        pushes = (location.pushes @ self.z).tolist() if location.pushes.size else []
        for j in range(len(self.inside)):
            self.inside[j] = _side(depths[j], self.inside[j])
            # Contact begins with a push: outside, none is required.
            self.pushing[j] = not (self.inside[j] and self.loop.is_damped(j)) or _side(
                pushes[j], self.pushing[j]
            )
        if was == (self.inside, self.pushing):
            return False
        after = self._in_contact()
        for j in sorted(set(before) ^ set(after)):
            surface = self.loop.scenario.surfaces[j]
            self.contacts.append((self.t, surface.environment, j in after))
            if j in after:
                self.direction = surface.sign
        self.location = self._enter()
        return True

    def _change_controller(self) -> bool:
        """Make the first switch that is due; tell whether there was one."""
        location, control = self.location, self.loop.scenario.control
        if not control.switches:
            return False
        values = (location.flow.signals @ self.z)[len(self.inside) + len(location.damped) :]
        for bound, value in zip(location.bounds, values.tolist(), strict=True):
            self.met[bound] = _side(value, self.met.get(bound, False))
        if self.t < self.since + control.stays.get(self.controller, 0.0):
            return False
        unmet = {i for i, k, end in location.bounds if not self.met[i, k, end]}
        for i, switch in enumerate(control.switches):
            if switch.source == self.controller and i not in unmet:
                self._record(self.z[None])
                self._switch(switch.target)
                return True
        return False

    def _switch(self, target: str) -> None:
        """Let another controller take over, and set what the spec says is set then."""
        if target == self.controller:
            return
        mode, spec, places, laws = self.location.mode, self.loop.spec, self.loop.index, self.laws
        self.z = self.z.copy()
        if spec.offset != "none":
            taken = mode.reference if spec.offset == "reference" else mode.angle
            self.z[places["commanded position"]] = float(taken @ self.z)
        leaves = laws[self.controller].commands == "velocity" != laws[target].commands
        if leaves and spec.idle_states is not None and spec.idle_states.reset:
            for name in (*state_names(laws[self.controller].states), "offset"):
                self.z[places[name]] = 0.0
        self.controller, self.since, self.met = target, self.t, {}
        self.switches.append((self.t, target))
        self.location = self._enter()

    def _record(self, states: Array, step: float = 0.0) -> None:
        """Keep states from now on, a step apart, and the location that gives their outputs."""
        self.kept.append((self.t, step, self.location.index, states))

    def _response(self) -> TimeResponse:
        starts, steps, entered, parts = zip(*self.kept, strict=True)
        counts = np.array([len(part) for part in parts])
        number = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        times = np.repeat(starts, counts) + np.repeat(steps, counts) * number
        which, states = np.repeat(entered, counts), np.concatenate(parts)
        rows, mode = np.empty((len(times), 4)), np.empty(len(times), np.int64)
        names = [c.name for c in self.loop.design.controllers]
        for location in self.locations.values():
            own, m = np.flatnonzero(which == location.index), location.mode
            outputs = np.stack([m.angle, m.velocity, m.torque, m.reference], axis=1)
            rows[own] = states[own] @ outputs
            mode[own] = names.index(location.controller)
        angle, velocity, torque, reference = rows.T
        states = states.T.copy()
        surfaces = self.loop.scenario.surfaces
        # Torques below the tolerance of contact are zero.
        stiffest = max((s.element.k for s in surfaces if s.element is not None), default=0.0)
        torque = np.where(np.abs(torque) <= 4 * TOLERANCE * (1 + stiffest), 0.0, torque)
        depths = [s.sign * (angle - s.at) for s in surfaces]
        depth = np.maximum(np.max(depths, axis=0), 0.0) if depths else np.zeros_like(angle)
        return TimeResponse(
            times,
            np.array([angle, velocity, torque, depth, reference]),
            states[:-3],
            states[-3:-2],
            (*OUTPUTS, Signal("reference", "rad")),
            self.loop.states[:-3],
            INPUTS,
            mode,
            tuple(names),
        )


def _side(value: float, known: bool) -> bool:
    """Tell whether a signal is above zero, or still counts so."""
    return value > -TOLERANCE if known else value > TOLERANCE
