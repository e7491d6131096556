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


def start_lines(law: StepLaw) -> Iterator[str]:
    """Yield the start-up requirements of a program other than starting at rest."""
    if any(value.name == "position" for value in law.inputs):
        yield PLACED
    if any(state.name == "commanded" for state in law.states):
        yield SPRUNG
