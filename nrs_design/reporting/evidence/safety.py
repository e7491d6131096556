"""What a safety layer keeps: its limits, and how far the loop goes below it."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import simulated
from nrs_design.reporting.figures.bounded_run import BoundedSignal, draw_bounded_run
from nrs_design.simulation.governed import hardest_run

_MEANING = (
    "The layer moves the reference of the motion loop, and the tissue does not load the motor. So "
    "how far the angle is from the reference follows from the steps of the reference alone: sums "
    "of the responses of one motor, and of what others of the range do beside, computed in "
    "rational numbers. Where the torque is beyond its limit, the reference goes no further in; the "
    "angle is at most its error, and the way since the torque was sampled, ahead."
)
_TEXT = (
    "What is kept at all times, not at samples alone. The proof takes no part of the controllers "
    "and of their modes."
)
_RUN = (
    "Simulated run from rest: every step of the reference is the largest that the layer lets pass, "
    "forward or back, as it does most to the last velocity. The motor is that in the middle of its "
    "range; the bound is for all of them. The run is no part of the proof."
)
_SIGNS = ("forward", "back")


class SafetyPage(AbstractPage):
    """The limits of the layer, and those that are proved of the robot."""

    name = "limits under a safety layer"

    def meaning(self) -> tuple[str, ...]:
        """Say what the limits rest on."""
        return (_MEANING,)

    def between_corners(self) -> tuple[str, ...]:
        """Say that motors within the ranges are covered."""
        return ("Motors and stiffnesses within their ranges are covered, however they change.",)

    def limits(self) -> tuple[str, ...]:
        """Say what does not follow."""
        return (
            "A surface that moves, and two surfaces that are touched at once.",
            "Work against the torque that acts, beside that against the measured one.",
            "Steps that the guards of the law refuse, and samples that come late.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the limits in a table."""
        loop = self.system.safety
        assert loop is not None, "the evidence is about it"
        proved = (
            ("Speed of the joint", "rad/s"),
            ("Reference less angle", "rad"),
            ("Command of the motor", loop.unit),
            ("Torque where the stiffness jumps", "N*m"),
            ("Torque at a constant stiffness", "N*m"),
            ("Energy stored at a constant stiffness", "J"),
        )
        rows = (
            ("Speed of the reference, by the layer", rounded_down(loop.speed, "rad/s")),
            ("Measured torque for a step inward, by the layer", rounded_down(loop.torque, "N*m")),
            ("Work of the reference, by the layer", rounded_down(loop.energy, "J")),
            *(
                (f"{name}, proved", rounded_up(number, unit))
                for (name, unit), number in zip(proved, self.offer.numbers, strict=True)
            ),
        )
        blocks = (Paragraph(_TEXT), Table("Safety layer", ("Quantity", "At most"), rows))
        return (Section("Safety layer", (*blocks, self._illustration())),)

    def run(self) -> Section:
        """Draw the speed of the joint under the hardest steps of the reference."""
        return simulated(self._illustration())

    def _illustration(self) -> Illustration:
        loop, period = self.system.safety, self.system.sample_time
        assert loop is not None, "the evidence is about it"
        assert period is not None, "it is sampled"
        run = hardest_run(loop, period)
        bound = np.full(len(run.time), float(self.offer.numbers[0]))
        signal = BoundedSignal("Velocity [rad/s]", run.state[:, 2:], float(loop.speed), bound)
        return Illustration(
            "safety-run",
            "Hardest steps below the safety layer",
            _RUN,
            draw_bounded_run(run, [signal], _SIGNS, "s"),
        )
