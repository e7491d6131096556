"""The laws of a robot's motion control in C99: one header and one source for all of them.

Nothing is proved of them: no certificate covers the nonlinear dynamics of three axes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from nrs_design import __version__
from nrs_design.controllers.operations import StepLaw
from nrs_design.exporters.c_names import CNames, block_comment, harmless
from nrs_design.exporters.c_step import (
    FLAGS,
    declarations,
    definitions,
    guards,
)
from nrs_design.exporters.outside import OUTSIDE
from nrs_design.exporters.template import fill_template
from nrs_design.output import C_HEADER, C_SOURCE
from nrs_design.ownership import MARK
from nrs_design.robot.exporters.robot_tree import RobotExport
from nrs_design.robot.pipeline import run_robot_laws
from nrs_design.spec import RobotSpec

UNPROVED = (
    "no certificate covers the nonlinear dynamics of three axes, with or without these laws: "
    "nothing is proved of them"
)
# By the end of their names in C.
PURPOSES: Mapping[str, str] = {
    "base": "gravity in the frame of the base, and the correction of the simplified dynamics, from "
    "the tilt of the base; to be called whenever the base has been moved",
    "pd": "a PD on each joint, for the balanced robot (thesis 4.36)",
    "pd_gravity": "a PD on each joint, with the corrected weight of the simplified dynamics fed "
    "forward (thesis 4.32)",
    "computed_torque": "computed torque with the corrected simplified dynamics (thesis 4.18)",
    "inverse_dynamics": "joint torques of a motion by the full dynamics of all links, without "
    "feedback; of the motors it knows nothing",
}
# In the place of a line that must not be wrapped: `check_export` reads it again.
_PLACE = "@"
_HEADER_ONLY = (
    "",
    "Once before: NAME_base_step with the tilt of the base; its outputs are inputs of the others. "
    "At every sample: the step of one law. Compile with",
    FLAGS,
    "and keep rounding to nearest, and subnormal numbers as they are. Without -fno-math-errno some "
    "compilers call sqrtf of libm, which rounds as IEEE 754 says.",
    "",
    "tilt: theta4, from -75 to 0 deg, where the table of corrections is: mean ratios over slow "
    "motions of the depth, as `nrs-design robot correction` prints them.",
    "angle_i: encoder of joint i, at the output of the gearhead. position_i, velocity_i, "
    "acceleration_i: of the joints themselves. Joints 1 and 2 are the planes of the side legs, 3 "
    "is the crank of the middle leg.",
    "init: the error before the first sample is taken for zero. Begin where the joints are, or "
    "call step once and discard its command: a difference in between is a kick of the derivative.",
    "",
    "Guards: a step is not valid where an input or a state is not a number or beyond its limit "
    "below, where a result is not a number or beyond 10^9 in its unit, and where the middle leg "
    "cannot be (inverse_dynamics: any leg). Then the outputs are 0 and the state stays as it was; "
    "what to do next is for the caller to say.",
    "Angles are limited to where the polynomials for their functions hold, 1.5 rad of joints 1 and "
    "2 and 2 rad of joint 3, and not to the workspace: near a singular pose torques grow without "
    "bound.",
    "",
    "Left out of the model: motors in inverse_dynamics, and in computed_torque their inertia and "
    "damping, which makes it track badly; friction, elastic links and cables, backlash, "
    "counter-masses and springs of the balance, contacts.",
)


def render(export: RobotExport) -> dict[str, bytes]:
    """Return header and source, by their endings.

    Parameters
    ----------
    export : RobotExport
        With a spec that has `control`.

    Raises
    ------
    DesignError
        If the spec lacks something, or its numbers contradict each other.
    """
    laws = laws_of(export)
    return {
        ".h": header_text(export, laws).encode(),
        ".c": source_text(export, laws).encode(),
    }


def laws_of(export: RobotExport) -> Mapping[str, StepLaw]:
    """Return the laws of a robot whose spec has `control`, by the end of their names in C."""
    spec = export.loaded.spec
    assert isinstance(spec, RobotSpec)
    return run_robot_laws(spec, export.robot)


def names_of(spec: str, law: str) -> CNames:
    """Return the names of a law in C.

    Parameters
    ----------
    spec : str
        Name of the spec.
    law : str
        As `PURPOSES` has it.
    """
    return CNames(f"{spec}-{law}")


def header_text(export: RobotExport, laws: Mapping[str, StepLaw]) -> str:
    """Return the header.

    Parameters
    ----------
    export : RobotExport
        Of which robot.
    laws : mapping of str to StepLaw
        As `run_robot_laws` returns them.
    """
    name = export.loaded.spec.name
    guard = f"{CNames(name).upper}_H"
    lines = [
        _comment(export, (*_HEADER_ONLY, *_saturation(laws)), C_HEADER),
        f"#ifndef {guard}\n#define {guard}\n",
        "#include <stdbool.h>\n",
        fill_template("begin_c.j2"),
    ]
    for law, operations in laws.items():
        lines.append(block_comment([PURPOSES[law]], f"/* {law}\n".encode()))
        lines.append(declarations(operations, names_of(name, law)))
    return "\n".join([*lines, fill_template("end_c.j2"), "#endif\n"])


def source_text(export: RobotExport, laws: Mapping[str, StepLaw]) -> str:
    """Return the source.

    Parameters
    ----------
    export : RobotExport
        Of which robot.
    laws : mapping of str to StepLaw
        As `run_robot_laws` returns them.
    """
    name = export.loaded.spec.name
    lines = [
        _comment(export, (f"More is in {name}.h.",), C_SOURCE),
        f'#include "{name}.h"\n\n#include <float.h>\n#include <math.h>\n#include <stdint.h>\n',
        guards(*laws.values(), about="the laws need", math=True),
    ]
    for law, operations in laws.items():
        lines.append(definitions(operations, names_of(name, law)))
    return "\n".join(lines)


def _saturation(laws: Mapping[str, StepLaw]) -> Iterator[str]:
    yield ""
    limited = any("command_limit" in law.coefficient for law in laws.values())
    yield (
        "Saturation: of the commands of the motors, at COMMAND_LIMIT below."
        if limited
        else "The commands of the motors do not saturate: the spec has no `largest_command` of its "
        "drive."
    )


def _comment(export: RobotExport, more: tuple[str, ...], first: bytes) -> str:
    spec = export.loaded.spec
    assert isinstance(spec, RobotSpec)
    period = "not said" if spec.control is None else spec.control.sample_period.text
    lines = (
        f"nrs-design {__version__}",
        f"spec: {spec.name}, sha256 {export.loaded.sha256}",
        _PLACE,
        "certificate: none",
        f"verdict: UNPROVED: {UNPROVED}",
        f"sample time: {period}",
        "units: SI, angles in rad; commands in rpm of the motor",
        *(f"outside any proof: {text}" for text in OUTSIDE),
        *more,
    )
    place = f" * {MARK}{harmless(export.origin)}\n"
    return block_comment(lines, first).replace(f" * {_PLACE}\n", place, 1)
