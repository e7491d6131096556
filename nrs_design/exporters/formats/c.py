"""The law in C99: a header with numbers and types, and a source with `init` and `step`.

No heap, no recursion, no function of libm, one rounding for each operation.
"""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.step_law import INTEGRAL_LIMIT
from nrs_design.controllers.step_logic import UNITS
from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.c_names import CNames, block_comment
from nrs_design.exporters.c_step import FLAGS, declarations, definitions, guards
from nrs_design.exporters.export import Export
from nrs_design.exporters.header import header_lines
from nrs_design.exporters.program import program_of
from nrs_design.exporters.record import ExportRecord
from nrs_design.exporters.start import sign_lines, start_lines
from nrs_design.exporters.template import fill_template
from nrs_design.output import C_HEADER, C_SOURCE

FORMAT = Format(
    "C99 for a processor: init and step in single precision, no heap, no libm",
    SAMPLED,
    {".h": C_HEADER, ".c": C_SOURCE},
    executable=True,
)

# What the mode logic sees, in words.
_SEEN = {"command": "velocity command", "torque": "torque"}


def render(export: Export) -> dict[str, bytes]:
    """Return header and source, by their endings."""
    program = program_of(export)
    parts = program.record, program.law, program.names
    return {".h": header_text(*parts).encode(), ".c": source_text(*parts).encode()}


def header_text(record: ExportRecord, law: StepLaw, names: CNames) -> str:
    """Return the header."""
    return fill_template(
        "law.h.j2",
        comment=block_comment(_header_lines(record, law, names), C_HEADER),
        names=names,
        law=law,
        declarations=declarations(law, names),
        units=UNITS,
        seen=_SEEN,
    )


def source_text(record: ExportRecord, law: StepLaw, names: CNames) -> str:
    """Return the source."""
    about = (*header_lines(record), f"More is in {record.spec.name}.h.")
    return fill_template(
        "law.c.j2",
        comment=block_comment(about, C_SOURCE),
        names=names,
        law=law,
        guards=guards(law),
        definitions=definitions(law, names),
    )


def _header_lines(record: ExportRecord, law: StepLaw, names: CNames) -> Iterator[str]:
    yield from header_lines(record)
    yield ""
    init = f"{names.lower}_init once, then " if law.states else ""
    yield f"Call {init}{names.lower}_step at every sample. Compile with"
    yield FLAGS
    yield "and keep rounding to nearest, and subnormal numbers as they are."
    yield from start_lines(law)
    yield ""
    yield from sign_lines(law)
    yield ""
    yield (
        "Guards, outside the proof: a step is not valid where the mode does not exist, or an input "
        "or a state is not a number or beyond its limit below. Then the command is 0 and the state "
        "stays as it was; what to do next is for the caller to say. A state that has left its "
        "limits is refused until init. Within the limits no operation overflows."
    )
    yield (
        "Saturation of the command of the motor, at COMMAND_LIMIT below: outside the proof, but "
        "for a region in which it may say that motions decay all the same."
        if "command_limit" in law.coefficient
        else "The command does not saturate: the spec has no `limits: command`."
    )
    if INTEGRAL_LIMIT in law.coefficient:
        yield (
            "The integral of the force error is cut off at INTEGRAL_LIMIT, both ways, at every "
            "sample and in every mode, so that it does not wind up."
        )
    if "velocity_limit" in law.coefficient:
        yield "The velocity command saturates at VELOCITY_LIMIT before the law takes it."
    if "d" in law.coefficient and 0 in law.coefficient["d"].values:
        yield (
            "Reset: what is set to zero when an impedance controller is left stays zero until the "
            "next one is active, so D is 0 in the modes of the others, not the d of the proof."
        )
    if law.logic is not None:
        yield ""
        yield (
            f"Mode logic: {names.lower}_logic_step returns the mode that is to be stepped, once a "
            "sample. Its signals are those of mode_logic in the spec, positive towards the tissue; "
            "one that is no number is no reason to switch. Thresholds are rounded away from each "
            "other, times up to whole samples: the time that a mode is held rests on one call a "
            "sample. A mode that does not exist becomes the first one. The proof does not rest on "
            "the signals: what it says of switching is among what it takes for granted."
        )
    if record.proof is not None:
        yield ""
        yield "Taken for granted by the proof:"
        yield from (f"- {text}" for text in record.proof.assumptions)
