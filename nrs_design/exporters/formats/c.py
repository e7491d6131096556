"""The law in C99: a header with numbers and types, a source with `init` and `step`, a self-test.

No heap, no recursion, no function of libm, one rounding for each operation.
"""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.operations import Operation, StepLaw
from nrs_design.controllers.parts import DEFAULT_LIMIT
from nrs_design.controllers.step_law import INTEGRAL_LIMIT
from nrs_design.controllers.step_logic import UNITS
from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.export import Export
from nrs_design.exporters.program import Program, program_of, sign_lines, start_lines
from nrs_design.exporters.self_test import draw_cases, self_test
from nrs_design.exporters.text import CNames, block_comment, fill_template
from nrs_design.output import C_HEADER, C_SOURCE, C_TEST, C_TEST_HEADER

FORMAT = Format(
    "C99 for a processor: init and step in single precision, no heap, no libm; a self-test",
    SAMPLED,
    {".h": C_HEADER, ".c": C_SOURCE, "_test.h": C_TEST_HEADER, "_test.c": C_TEST},
    executable=True,
)

SIGN = {"add": "+", "subtract": "-", "multiply": "*"}
FLAGS = (
    "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror -ffp-contract=off"
)
# Signals of the mode logic, as text.
_SIGNAL_TEXTS = {"command": "velocity command", "torque": "torque"}


def render(export: Export) -> dict[str, bytes]:
    """Return header and source of the law and of its self-test, by their endings."""
    program = program_of(export)
    return {
        ".h": header_text(program).encode(),
        ".c": source_text(program).encode(),
        **self_test(program.law, draw_cases(program.law), program.names, program.description),
    }


def header_text(program: Program) -> str:
    """Return the header."""
    return fill_template(
        "law.h.j2",
        comment=block_comment(_header_lines(program), C_HEADER),
        names=program.names,
        law=program.law,
        beyond=(DEFAULT_LIMIT, 2 * DEFAULT_LIMIT),
        units=UNITS,
        seen=_SIGNAL_TEXTS,
    )


def source_text(program: Program) -> str:
    """Return the source: one line for each operation, one rounding for each line.

    Guards refuse wrong input; no proof covers them.
    """
    law, names = program.law, program.names
    description = (*program.description, f"More is in {names.spec}.h.")
    results = {f"out->{name}": value for name, value in law.outputs.items()}
    results |= {f"state->{name}": value for name, value in law.following.items()}
    range_checks = [
        f"is_within({_operand(law, names, v.name)}, {names.limit(v)})" for v in law.values
    ]
    return fill_template(
        "law.c.j2",
        comment=block_comment(description, C_SOURCE),
        names=names,
        law=law,
        guards=[f"(in->mode < {names.modes})", *range_checks],
        operations=[(one.name, _expression(law, names, one)) for one in law.operations],
        results=[(place, _operand(law, names, value)) for place, value in results.items()],
    )


def _expression(law: StepLaw, names: CNames, operation: Operation) -> str:
    left, right = (_operand(law, names, name) for name in (operation.first, operation.second))
    if operation.kind == "saturate":
        return f"saturated({right}, {left})"
    return f"{left} {SIGN[operation.kind]} {right}"


def _operand(law: StepLaw, names: CNames, name: str) -> str:
    if name in law.coefficient:
        coefficient = law.coefficient[name]
        return (
            f"{name}_of[in->mode]"
            if coefficient.differs_by_mode
            else names.coefficient(coefficient)
        )
    if any(value.name == name for value in law.inputs):
        return f"in->{name}"
    return f"state->{name}" if any(value.name == name for value in law.states) else name


def _header_lines(program: Program) -> Iterator[str]:
    record, law, names = program.record, program.law, program.names
    yield from program.description
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
