"""Sampled loops with a motor in hand, of which a period is looked at as rows."""

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.step_law import StepFrame
from nrs_design.loop.calendar import Calendar, CommandTiming, Turn
from nrs_design.loop.flow import HeldDrive
from nrs_design.loop.program import SampledProgram
from nrs_design.loop.sampled import SampledLoop
from nrs_design.models.drive import Drive, motor_drive
from nrs_design.models.interval import Interval


@dataclass(frozen=True)
class Frame:
    """A loop, and what moves it."""

    timing: CommandTiming
    drive: Drive
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
        return SampledLoop(program, self.drive, calendar)

    def rows(self, law, delay, values, turn=Turn.BOTH):
        """Return the map of a period, below it the sizes of roundings, and the command.

        Of a drive that is known, at the gain that is given, but for the last digits.
        """
        contact = values.get("k", Fraction(0)), values.get("b", Fraction(0))
        flow = HeldDrive(self.drive.fix_values(values), self.timing).flow()[0].rows
        period = self.loop.period(self.loop.sample(law, delay, contact, turn), flow)
        return [*period.moves, *period.sizes, period.command]


def frame_of(period, step, laws, delay, tau, *others, **named):
    """Return a loop whose commands take effect at once, with a motor that is known."""
    timing = CommandTiming(Fraction(period))
    drive = motor_drive(Interval.point(Fraction(1, 2000)), Interval.point(Fraction(tau)))
    return Frame(timing, drive, step, laws, delay, *others, **named)
