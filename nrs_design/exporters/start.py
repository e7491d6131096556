"""Start-up requirements: with them, the first samples of a program are those of the proof."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.operations import StepLaw

SPRUNG = (
    "init takes the springs Kt for unloaded: call it where the contact carries no force, which is "
    "the point of rest of the proof. Called with tissue pressed in, it moves that point there: a "
    "force of up to Kt times the depth stays, and changes with stiffness and controller."
)
PLACED = (
    "init knows nothing of the joint, and takes the error of the sample before for zero: let "
    "`position` of the first step be the angle of the joint, or the PD differentiates all that "
    "lies between them, and the joint moves there at once."
)
STREAMED = (
    "The command is a position, and `position` goes into it as it is: let that of the first step "
    "be the angle of the joint, or the robot moves there at once."
)
TWICE = (
    "What the hand commands goes in once: move `position` and leave `velocity_command` zero, or "
    "hold `position` while an impedance controller takes `velocity_command`."
)


def start_lines(law: StepLaw) -> Iterator[str]:
    """Yield the start-up requirements of a program other than starting at rest."""
    inputs = {value.name for value in law.inputs}
    if "position" in inputs:
        differentiates = any(state.name == "error_before" for state in law.states)
        yield PLACED if differentiates else STREAMED
    if {"position", "velocity_command"} <= inputs:
        yield TWICE
    if "Kt" in law.coefficient:
        yield SPRUNG
