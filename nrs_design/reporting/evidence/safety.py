"""What a safety layer keeps: its limits, and how far the loop goes below it."""

from __future__ import annotations

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence.safety_layer import SafetyLayer
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.evidence.page import AbstractPage

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
            "A surface that moves, two surfaces that are touched at once, and tissue that damps.",
            "Work against the torque that acts, beside that against the measured one.",
            "Steps that the guards of the law refuse, and samples that come late.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the limits in a table."""
        loop, evidence = self.system.safety, self.evidence
        assert loop is not None, "the evidence is about it"
        assert isinstance(evidence, SafetyLayer), "no other shows this"
        most = evidence.limits
        rows = (
            ("Speed of the reference, by the layer", rounded_down(loop.speed, "rad/s")),
            ("Measured torque for a step inward, by the layer", rounded_down(loop.torque, "N*m")),
            ("Work of the reference, by the layer", rounded_down(loop.energy, "J")),
            ("Speed of the joint, proved", rounded_up(most.velocity, "rad/s")),
            ("Reference less angle, proved", rounded_up(most.error, "rad")),
            ("Command of the motor, proved", rounded_up(most.command, loop.unit)),
            ("Torque where the stiffness jumps, proved", rounded_up(most.torque, "N*m")),
            ("Torque at a constant stiffness, proved", rounded_up(most.steady, "N*m")),
            ("Energy stored at a constant stiffness, proved", rounded_up(most.stored, "J")),
        )
        blocks = (Paragraph(_TEXT), Table("Safety layer", ("Quantity", "At most"), rows))
        return (Section("Safety layer", blocks),)

    def run(self) -> Section:
        """Show the table again: there is no run of modes."""
        return self.sections()[0]
