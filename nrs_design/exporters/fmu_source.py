"""The C around a law that makes it a co-simulation model by FMI 2.0.

Numbers pass as doubles and are rounded to single precision where the law takes them.
"""

from __future__ import annotations

from nrs_design.controllers.operations import StepLaw
from nrs_design.exporters.c_names import block_comment
from nrs_design.exporters.fmu_instance import INSTANCE
from nrs_design.exporters.fmu_interface import INTERFACE
from nrs_design.exporters.fmu_steps import STEPS
from nrs_design.exporters.fmu_values import VALUES
from nrs_design.exporters.fmu_variables import Variables
from nrs_design.exporters.program import Program
from nrs_design.output import C_SOURCE


def wrapper_text(program: Program, guid: str, period: str) -> str:
    """Return the source of the wrapper.

    Parameters
    ----------
    program : Program
        The law that is wrapped.
    guid : str
        By which the description and the program know each other.
    period : str
        Sample time in s, as a decimal.
    """
    law, names = program.law, program.names
    variables = Variables.of(law)
    parts = {
        "ABOUT": block_comment(
            (*program.about, "It makes a model by FMI 2.0 of the law."), C_SOURCE
        ),
        "SPEC": names.spec,
        "OWN": names.lower,
        "GUID": guid,
        "PERIOD": period,
        "REALS": _cases(variables),
        "INPUTS": str(len(law.inputs)),
        "CLEAR": _clear(law),
    }
    text = INTERFACE + INSTANCE + VALUES + STEPS
    for key, value in parts.items():
        text = text.replace(f"@{key}@", value)
    return text


def _cases(variables: Variables) -> str:
    lines = [f"    case {v.reference}U:\n        return &m->{v.place};\n" for v in variables.reals]
    return "".join(lines)


def _clear(law: StepLaw) -> str:
    zero = [f"    m->in.{v.name} = 0.0F;\n" for v in law.inputs]
    zero += [f"    m->out.{name} = 0.0F;\n" for name in law.outputs]
    return "".join(zero)
