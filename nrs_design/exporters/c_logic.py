"""The mode logic in C99, where a spec has one of thresholds: which mode is to be stepped next."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.step_logic import UNITS, StepLogic, StepSwitch
from nrs_design.exporters.c_names import CNames, literal

_SEEN = {"command": "velocity command", "torque": "torque"}


def logic_lines(law: StepLaw, names: CNames) -> Iterator[str]:
    """Yield what a header says of the mode logic of a law, if it has one."""
    if law.logic is None:
        return
    yield ""
    yield (
        f"Mode logic: {names.lower}_logic_step returns the mode that is to be stepped, once a "
        "sample. Its signals are those of mode_logic in the spec, positive towards the tissue; one "
        "that is no number is no reason to switch. Thresholds are rounded away from each other, "
        "times up to whole samples: the time that a mode is held rests on one call a sample. A "
        "mode that does not exist becomes the first one. The proof does not rest on the signals: "
        "what it says of switching is among what it takes for granted."
    )


def logic_declarations(law: StepLaw, names: CNames) -> list[str]:
    """Return what a header declares of the mode logic of a law, if it has one."""
    if law.logic is None:
        return []
    fields = "".join(
        f"    float {name}; /* {UNITS[name]}: {_SEEN[name]} that the logic sees */\n"
        for name in law.logic.signals
    )
    return [
        "".join(_macros(law, law.logic, names)),
        "/* What the mode logic sees, positive towards the tissue. */\n"
        f"typedef struct {{\n{fields}}} {names.lower}_signals_t;\n",
        "/* The state of the mode logic. */\ntypedef struct {\n    uint32_t mode;\n"
        "    uint32_t held; /* samples for which the mode has been active */\n"
        f"}} {names.lower}_logic_t;\n",
        "\n".join(f"{prototype};" for prototype in _prototypes(names)) + "\n",
    ]


def logic_definitions(law: StepLaw, names: CNames) -> list[str]:
    """Return the functions of the mode logic of a law, if it has one."""
    if law.logic is None:
        return []
    init, step = _prototypes(names)
    start = f"    logic->mode = {names.start};\n    logic->held = 0U;\n"
    return [
        f"{init}\n{{\n{start}}}\n",
        f"{step}\n{{\n{''.join(_step(law, law.logic, names))}}}\n",
    ]


def _macros(law: StepLaw, logic: StepLogic, names: CNames) -> Iterator[str]:
    yield "/* The mode logic: first mode, samples for which a mode is held, thresholds. */\n"
    units = {
        names.threshold(index, bound): UNITS[bound.signal]
        for index, switch in enumerate(logic.switches, 1)
        for bound in switch.bounds
    }
    for macro, number in names.logic(logic, law.modes).items():
        if isinstance(number, int):
            yield f"#define {macro} {number}U\n"
        else:
            note = f"{exact_decimal(number)} {units[macro]}"
            yield f"#define {macro} {literal(number)} /* {note} */\n"


def _prototypes(names: CNames) -> tuple[str, str]:
    own = names.lower
    return (
        f"void {own}_logic_init({own}_logic_t *logic)",
        f"uint32_t {own}_logic_step(\n    const {own}_signals_t *seen,\n    {own}_logic_t *logic)",
    )


def _step(law: StepLaw, logic: StepLogic, names: CNames) -> Iterator[str]:
    holds = "".join(f"        {names.hold(mode)},\n" for mode in law.modes)
    yield f"    static const uint32_t hold_of[{names.modes}] = {{\n{holds}    }};\n"
    yield f"    const bool known = logic->mode < {names.modes};\n"
    yield f"    const uint32_t before = known ? logic->mode : {names.start};\n"
    yield "    uint32_t after = before;\n\n"
    yield "    if (known && (logic->held >= hold_of[before])) {\n"
    for index, switch in enumerate(logic.switches, 1):
        following = "} else " if index > 1 else ""
        yield f"        {following}if ({_condition(law, switch, index, names)}) {{\n"
        yield f"            after = {names.mode(law.modes[switch.target])};\n"
    yield "        } else {\n            /* No switch is due. */\n        }\n    }\n"
    yield "    if ((after != before) || !known) {\n        logic->held = 1U;\n"
    yield "    } else if (logic->held < UINT32_MAX) {\n        logic->held++;\n"
    yield "    } else {\n        /* The count stays at its end. */\n    }\n"
    yield "    logic->mode = after;\n    return after;\n"


def _condition(law: StepLaw, switch: StepSwitch, index: int, names: CNames) -> str:
    parts = [f"(before == {names.mode(law.modes[switch.source])})"]
    for bound in switch.bounds:
        sign = ">=" if bound.above else "<="
        parts.append(f"(seen->{bound.signal} {sign} {names.threshold(index, bound)})")
    return " &&\n            ".join(parts)
