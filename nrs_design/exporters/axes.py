"""The admittance of three axes in C99: one step for all of them, in a header and a source."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from nrs_design.controllers.axes_law import build_axes_law, lacks_axes
from nrs_design.controllers.operations import StepLaw
from nrs_design.errors import DesignError
from nrs_design.exporters.c_names import CNames, block_comment
from nrs_design.exporters.c_step import (
    FLAGS,
    MAGNITUDE_WITHIN,
    REFUSALS,
    declarations,
    definitions,
    helpers,
)
from nrs_design.exporters.export import Export
from nrs_design.exporters.program import Program, program_of
from nrs_design.output import C_AXES, C_AXES_HEADER

UNPROVED = (
    "of the step of three axes nothing is proved: it has neither the motor loop nor the reference, "
    "and a proof is about the step of one axis, which --format c writes"
)


def render(export: Export) -> dict[str, bytes]:
    """Return header and source, by their endings.

    Parameters
    ----------
    export : Export
        With a record, proved or not.

    Raises
    ------
    DesignError
        If there is no program of a controller, or none of three axes.
    """
    program = program_of(export)
    if lack := lacks_axes(program.law):
        raise DesignError(lack, remedy="use --format c, and call the step of one axis three times")
    law = build_axes_law(program.law)
    return {
        "_axes.h": header_text(program, law).encode(),
        "_axes.c": source_text(program, law).encode(),
    }


def remarks(_: Mapping[str, bytes]) -> tuple[str, ...]:
    """Say what rendered files lack."""
    return (UNPROVED,)


def names_of(spec: str) -> CNames:
    """Return the names of the law in C.

    Parameters
    ----------
    spec : str
        Name of the spec.
    """
    return CNames(f"{spec}-axes")


def header_text(program: Program, law: StepLaw) -> str:
    """Return the header.

    Parameters
    ----------
    program : Program
        The law of one axis, and what is proved of it.
    law : StepLaw
        That of three.
    """
    names = names_of(program.names.spec)
    guard = f"{names.upper}_H"
    lines = [
        block_comment((*_about(program), *_use(names)), C_AXES_HEADER),
        f"#ifndef {guard}\n#define {guard}\n",
        "#include <stdbool.h>\n#include <stdint.h>\n",
        *declarations(law, names),
        "#endif\n",
    ]
    return "\n".join(lines)


def source_text(program: Program, law: StepLaw) -> str:
    """Return the source.

    Parameters
    ----------
    program : Program
        The law of one axis, and what is proved of it.
    law : StepLaw
        That of three.
    """
    spec = program.names.spec
    lines = [
        block_comment((*_about(program), f"More is in {spec}_axes.h."), C_AXES),
        f'#include "{spec}_axes.h"\n\n#include <float.h>\n#include <math.h>\n',
        REFUSALS,
        *helpers(law, within=MAGNITUDE_WITHIN),
        *definitions(law, names_of(spec)),
    ]
    return "\n".join(lines)


def _about(program: Program) -> Iterator[str]:
    """Yield what every file says; the verdict of the record is that of another step."""
    for line in program.about:
        key, _, text = line.partition(": ")
        if key == "verdict":
            yield f"verdict: UNPROVED: {UNPROVED}"
            yield f"verdict on the step of one axis: {text}"
        else:
            yield f"claim, not about this step: {text}" if key == "claim" else line


def _use(names: CNames) -> Iterator[str]:
    own = names.lower
    yield ""
    yield f"Call {own}_init once, then {own}_step at every sample. Compile with"
    yield FLAGS
    yield "and keep rounding to nearest, and subnormal numbers as they are."
    yield ""
    yield (
        "moves_i: velocity of the admittance of axis i after the torque of this sample. The "
        "reference of the axis moves on by the sample time times the velocity that the hand "
        "commands, which is to be limited before, less the velocity of the sample before, which is "
        "that of the state."
    )
    yield (
        "One mode for all three axes. Where each may be under a controller of its own, take the "
        "step of one axis three times."
    )
    yield ""
    yield (
        "Guards, outside the proof: a step is not valid where the mode does not exist, or an input "
        "or a state is not a number or beyond its limit below. Then the velocities are 0 and the "
        "state stays as it was; what to do next is for the caller to say. A state that has left "
        "its limits is refused until init. Within the limits no operation overflows."
    )
