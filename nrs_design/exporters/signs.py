"""Sign and frame of every input and output of a law: which way is positive, and from where."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from nrs_design.controllers.operations import StepLaw

SIGNS: Mapping[str, str] = MappingProxyType(
    {
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
)
WRONG = (
    "Of a torque or an angle of the other sign the proof says nothing: the loop then adds to what "
    "it should oppose. Vectors do not see it: push the joint by hand, and look at both signs."
)


def sign_lines(law: StepLaw) -> Iterator[str]:
    """Yield sign and frame of each input and output of a program."""
    yield "Signs and frames:"
    for name in (*(value.name for value in law.inputs), *law.outputs):
        yield f"- {name}: {SIGNS[name]}"
    yield WRONG
