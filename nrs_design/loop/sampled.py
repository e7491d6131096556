"""One period of a sampled loop, exactly: a sample of the program, and the flow until the next.

The state is ``[reference or e, drive, e before, u held, commands sent, other states of the law,
force samples, deflection]``, as far as a loop has them (docs/certificates/drives.md). Positions
that are commanded, or the reference of impedance controllers, count from the deflection.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.loop.calendar import Calendar, Turn
from nrs_design.loop.located import Period
from nrs_design.loop.program import (
    CUT_OFF,
    ENCODER,
    FORCE_ERROR,
    FRICTION,
    INPUTS,
    LAST_ERROR,
    REFERENCE,
    ROUNDED_ANGLE,
    SampledProgram,
)
from nrs_design.loop.wires import Wires
from nrs_design.models.drive import OMEGA, CommandInterface, Drive
from nrs_design.models.linear_form import ONE, ZERO, LinearForm

DELTA, HELD_COMMAND = "delta [rad]", "u held"
# Rows of the states of a drive and of the joint motion. The columns are the states, the deflection,
# the command in force at the start of a period, and later changes of the command.
Rows = Mapping[str, tuple[Fraction, ...]]
# Stiffness and damping of what a force sample shows.
Contact = tuple[Fraction, Fraction]
NOTHING: Contact = (ZERO, ZERO)


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Result of a sample, before the flow of the period."""

    wires: Wires
    states: Mapping[str, LinearForm]  # States that are known then
    # Issued commands, the newest first; the last is in force when the period begins.
    commands: Sequence[LinearForm]
    sizes: tuple[LinearForm, ...]
    command: LinearForm

    def does(self, sample: Sample) -> bool:
        """Tell whether another sample does the same."""
        mine = self.states, self.commands, self.sizes
        return mine == (sample.states, sample.commands, sample.sizes)


@dataclass(frozen=True, eq=False)
class SampledLoop:
    """Program, drive and calendar of a loop; contact and flow are arguments of its methods."""

    program: SampledProgram
    drive: Drive
    calendar: Calendar

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        stored, calendar = self.program.stored, self.calendar
        place = [stored[name] for name in self.program.places]
        before = [stored[LAST_ERROR]] if LAST_ERROR in stored else []
        lasting = [HELD_COMMAND] if calendar.holds else []
        others = [text for text in stored.values() if text not in (*place, *before)]
        leading = (*self.drive.states, *before, *lasting, *calendar.pending)
        return (*place, *leading, *others, *calendar.samples, DELTA)

    @cached_property
    def relative_states(self) -> frozenset[str]:
        """The states that count from the deflection."""
        stored, is_position = (
            self.program.stored,
            self.program.step.interface is CommandInterface.POSITION,
        )
        lasting = (HELD_COMMAND,) if self.calendar.holds else ()
        commands = (*lasting, *self.calendar.pending) if is_position else ()
        return frozenset((*commands, *([stored[REFERENCE]] if REFERENCE in stored else [])))

    @cached_property
    def takes_force(self) -> bool:
        """Whether some law uses the force sample, so that delayed samples are states."""
        spring = ONE, ZERO
        return not all(
            self.sample(law, 0, spring).does(self.sample(law, 0, NOTHING))
            for law in self.program.laws
        )

    @property
    def shown_later(self) -> tuple[str, ...]:
        """The states that show a force later: samples on their way, and the lags of its filter."""
        return (*self.calendar.samples, *self.program.lags)

    def sample(
        self, law: DiscreteLaw, age: int, contact: Contact, turn: Turn = Turn.BOTH
    ) -> Sample:
        """Return the result of a sample in a contact.

        `age` is that of the force sample. What `turn` does not compute holds what it had.
        """
        w, calendar, stored = self._wires(), self.calendar, self.program.stored
        (k, b), memory = contact, self.drive.memory
        pressed = ((k, w[DELTA]), *([(-k, w[memory])] if memory else []))
        w.rule("now", lambda: w.sum(*pressed, (b, w[OMEGA]), (ONE, w[FORCE_ERROR])))
        w.rule("felt", lambda: w[calendar.samples[age - 1]] if age else w["now"])
        w.rule("measured", lambda: w.sum(*((ONE, w[s]) for s in (DELTA, ENCODER, ROUNDED_ANGLE))))
        sizes = {} if turn.is_miss else self.program.wire(w, law, turn)
        if turn is Turn.ZEROED:
            w.set({"command": w.nothing})
        elif not w.has("command"):
            # The newest of the delayed commands is issued again.
            w.rule("command", lambda: w[HELD_COMMAND if calendar.holds else calendar.pending[0]])
        cut_share = ZERO if turn.is_miss or turn is Turn.ADMITTANCE else ONE
        commands = [
            w.sum((ONE, w["command"]), (cut_share, w[CUT_OFF])),
            *(w[name] for name in calendar.pending),
        ]
        ages = [
            *([] if turn is Turn.MOTION else [w["now"]]),
            *(w[name] for name in calendar.samples),
        ]
        states = {s: w[f"{n}+"] if w.has(f"{n}+") else w[n] for n, s in stored.items()}
        states |= dict(zip(calendar.samples, ages, strict=False))
        states |= dict(zip(calendar.pending, commands, strict=False))
        states |= {HELD_COMMAND: commands[0]} if calendar.holds else {}
        bounds = tuple(sizes.get(name, w.nothing) for name in self.program.roundings)
        return Sample(w, states, commands, bounds, w["command"])

    def period(self, sample: Sample, rows: Rows) -> Period:
        """Return the map of a sample and of the flow after it; `rows` describe the drive."""
        w, commands, ages = sample.wires, sample.commands, self.calendar.timing.new_ages
        columns = [
            *(w[name] for name in self.drive.states),
            w[DELTA],
            w.sum((ONE, commands[-1]), (ONE, w[FRICTION])),
            *(w.sum((ONE, commands[age]), (-ONE, commands[age + 1])) for age in ages),
        ]

        states = dict(sample.states)
        for name in (*self.drive.states, DELTA):
            offset = [(ONE, w[DELTA])] if name == DELTA else []
            states[name] = w.sum(*offset, *zip(rows[name], columns, strict=True))
        delta = states[DELTA]
        moves = (
            w.sum((ONE, states[s]), (-ONE, delta)) if s in self.relative_states else states[s]
            for s in self.states
        )
        return Period(tuple(moves), sample.sizes, sample.command)

    def _wires(self) -> Wires:
        """Return the wires of a sample: states as they are, inputs and roundings."""
        w = Wires((*self.states, *INPUTS, *self.program.roundings))
        w.set({s: w.sum((ONE, w[s]), (ONE, w[DELTA])) for s in self.relative_states})
        w.set({name: w[text] for name, text in self.program.stored.items()})
        return w
