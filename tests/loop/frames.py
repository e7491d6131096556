"""Sampled loops with a motor in hand, of which a period is looked at as rows."""

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.step_law import StepFrame
from nrs_design.loop.calendar import Calendar, Turn
from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.held import flow_rows
from nrs_design.loop.held_motor import HeldMotor, hold
from nrs_design.loop.program import SampledProgram
from nrs_design.loop.sampled import SampledLoop
from nrs_design.models.actuator import Actuator, ActuatorRanges


@dataclass(frozen=True)
class Frame:
    """A loop, and what moves it."""

    timing: CommandTiming
    motor: HeldMotor
    step: StepFrame
    laws: tuple
    longest_delay: int
    idle: Fraction | None = None
    turns: tuple[Turn, ...] = (Turn.BOTH,)

    def __getattr__(self, name):
        """Look for what is not here in the loop, its program and its calendar."""
        loop = self.loop
        return next(
            getattr(x, name) for x in (loop, loop.program, loop.calendar) if hasattr(x, name)
        )

    @property
    def loop(self):
        calendar = Calendar(self.timing, (0, self.longest_delay), self.turns)
        program = SampledProgram(self.step, self.laws, self.idle)
        return SampledLoop(program, self.step.takes, self.motor.states, calendar)

    def rows(self, law, delay, values, turn=Turn.BOTH):
        """Return the map of a period, below it the sizes of roundings, and the command."""
        contact = values.get("k", Fraction(0)), values.get("b", Fraction(0))
        flow = flow_rows(self.motor, len(self.timing.within), values)
        period = self.loop.period(self.loop.sample(law, delay, contact, turn), flow)
        return [*period.moves, *period.sizes, period.command]


def frame_of(period, step, laws, delay, tau, *others, **named):
    """Return a loop whose commands take effect at once, with a motor that is known."""
    timing = CommandTiming(Fraction(period))
    motor = hold(ActuatorRanges.point(Actuator(Fraction(1, 2000), Fraction(tau))), timing)
    return Frame(timing, motor, step, laws, delay, *others, **named)
