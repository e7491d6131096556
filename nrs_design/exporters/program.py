"""A law that a processor runs, with requirements on its caller: start-up, signs and frames.

With the start-up requirements, the first samples of a program are those of the proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.shipped import shipped_law
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import ExportRecord, header_lines
from nrs_design.exporters.text import CNames


@dataclass(frozen=True, slots=True)
class Program:
    """A law that a processor runs."""

    record: ExportRecord  # Gains and proof
    law: StepLaw  # Its operations
    names: CNames  # Names in C

    @property
    def description(self) -> tuple[str, ...]:
        """Header lines of every exported file."""
        return header_lines(self.record)


def program_of(export: Export) -> Program:
    """Return the program of an export.

    A `DesignError` if nothing may be exported, a controller has no program, or names coincide in C.
    """
    record = export.shipped()
    assert export.spec is not None
    assert export.design is not None
    assert record.sample_time is not None
    law = shipped_law(export.spec, export.design, Fraction(record.sample_time.exact))
    names = CNames(record.spec.name)
    names.check(law)
    return Program(record, law, names)


SPRUNG = (
    "init takes the springs Kt for unloaded: call it where the contact carries no force, which is "
    "the point of rest of the proof. Called with tissue pressed in, it moves that point there: a "
    "force of up to Kt times the depth stays, and changes with stiffness and controller."
)
POSITION_START = (
    "init knows nothing of the joint, and takes the error of the sample before for zero: let "
    "`position` of the first step be the angle of the joint, or the PD differentiates all that "
    "lies between them, and the joint moves there at once."
)
STREAMED = (
    "The command is a position, and `position` goes into it as it is: let that of the first step "
    "be the angle of the joint, or the robot moves there at once."
)
SINGLE_INPUT = (
    "What the hand commands goes in once: move `position` and leave `velocity_command` zero, or "
    "hold `position` while an impedance controller takes `velocity_command`."
)


def start_lines(law: StepLaw) -> Iterator[str]:
    """Yield the start-up requirements of a program in addition to a start at rest."""
    inputs = {value.name for value in law.inputs}
    if "position" in inputs:
        differentiates = any(state.name == "error_before" for state in law.states)
        yield POSITION_START if differentiates else STREAMED
    if {"position", "velocity_command"} <= inputs:
        yield SINGLE_INPUT
    if "Kt" in law.coefficient:
        yield SPRUNG


SIGNS = {
    "angle": "where the joint is on its axis, behind the gear: turned or, where it slides, "
    "moved; positive the way in which a positive command moves it; zero anywhere, but the same "
    "place for all angles",
    "torque": "torque (force times lever arm) or, where the axis slides, force, measured on "
    "the axis of the joint between joint and tissue; positive where the tissue pushes the "
    "joint towards smaller angles, that is where the joint pushes towards larger ones",
    "velocity_command": "rate that the hand commands; positive towards larger angles",
    "position": "wanted `angle`: of the same axis, sign and zero",
    "wanted_torque": "wanted `torque`: of the same axis and sign",
    "command": "what the drive takes, before it; positive towards larger angles",
}
WRONG = (
    "Of a torque or an angle of the other sign the proof says nothing: the loop then adds to what "
    "it should oppose. The self-test does not see it: push the joint by hand, and look at both "
    "signs."
)


def sign_lines(law: StepLaw) -> Iterator[str]:
    """Yield sign and frame of each input and output of a program."""
    yield "Signs and frames:"
    for name in (*(value.name for value in law.inputs), *law.outputs):
        yield f"- {name}: {SIGNS[name]}"
    yield WRONG
