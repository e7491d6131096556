"""What a co-simulation model says of itself: `modelDescription.xml` by FMI 2.0, and a page."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from xml.sax.saxutils import quoteattr

from nrs_design.controllers.operations import StepLaw
from nrs_design.exporters.c_names import harmless
from nrs_design.exporters.fmu_variables import Variable, Variables
from nrs_design.exporters.program import Program
from nrs_design.exporters.start import start_lines

# By base units of SI; those of motors that are none have a name only.
_BASE = {
    "rad": 'rad="1"',
    "rad/s": 'rad="1" s="-1"',
    "N*m": 'kg="1" m="2" s="-2"',
    # 2 pi / 60.
    "rpm": 'rad="1" s="-1" factor="0.10471975511965977"',
    "V": 'kg="1" m="2" s="-3" A="-1"',
    "A": 'A="1"',
}
TIMING = (
    "A step from t on takes the inputs that are set at t. What it commands is for the time from t "
    "on: step this model first, hand its command over, then step the motor across the same time. "
    "A master that hands it over after the step makes the loop one sample slower than the proof "
    "says."
)
OUTSIDE = (
    TIMING,
    "Inputs arrive as doubles and are rounded to single precision once. A communication step is a "
    "whole number of sample times; others are refused. In one of many samples inputs are held, and "
    "of the commands the last one is seen alone: the loop of the proof has steps of one.",
    "A simulation shows one run. It proves nothing, and it is no part of the proof.",
)


def description(program: Program, guid: str, period: str) -> str:
    """Return the description as XML.

    Parameters
    ----------
    program : Program
        The law.
    guid : str
        By which description and program know each other.
    period : str
        Sample time in s, as a decimal.
    """
    record, law, names = program.record, program.law, program.names
    variables = Variables.of(law)
    summary = f"{record.verdict.upper()}: the law of {record.spec.name}, every {period} s"
    return f"""\
<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName={quoteattr(names.spec)} guid={quoteattr(guid)}
  description={quoteattr(summary)}
  generationTool={quoteattr(f"nrs-design {record.package.version}")}
  variableNamingConvention="structured" numberOfEventIndicators="0">
  <CoSimulation modelIdentifier="{names.lower}" canHandleVariableCommunicationStepSize="true">
    <SourceFiles><File name="fmu.c"/><File name="{names.spec}.c"/></SourceFiles>
  </CoSimulation>
  <UnitDefinitions>
{"".join(_units(variables))}  </UnitDefinitions>
  <LogCategories><Category name="logStatusError"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="1" stepSize="{period}"/>
  <ModelVariables>
{_integer(law)}{"".join(map(_real, variables.reals))}{_VALID}  </ModelVariables>
  <ModelStructure>
    <Outputs>{_unknown(variables)}</Outputs>
    <InitialUnknowns>{_unknown(variables)}</InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def page(program: Program, binary: str) -> str:
    """Return the documentation as HTML.

    Parameters
    ----------
    program : Program
        The law.
    binary : str
        What is compiled, in words.
    """
    proof, names = program.record.proof, program.names
    assumed = proof.assumptions if proof is not None else ()
    sections = (
        ("What this is", (*program.about, binary)),
        ("Outside the proof, in this format", OUTSIDE),
        ("How to start it", tuple(start_lines(program.law))),
        ("Taken for granted by the proof", assumed),
        ("Modes", tuple(f"{k}: {mode}" for k, mode in enumerate(program.law.modes))),
    )
    body = "".join(
        f"<h2>{escape(title)}</h2>\n{_list(lines)}" for title, lines in sections if lines
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head><meta charset="utf-8">'
        f"<title>{names.spec}</title></head>\n<body>\n<h1>{names.spec}</h1>\n{body}</body>\n</html>\n"
    )


def _list(lines: tuple[str, ...]) -> str:
    return "<ul>\n" + "".join(f"<li>{escape(harmless(line))}</li>\n" for line in lines) + "</ul>\n"


def _units(variables: Variables) -> Iterator[str]:
    for unit in dict.fromkeys(variable.unit for variable in variables.reals):
        base = f"<BaseUnit {_BASE[unit]}/>" if unit in _BASE else ""
        yield f"    <Unit name={quoteattr(unit)}>{base}</Unit>\n"


def _integer(law: StepLaw) -> str:
    modes = ", ".join(f"{k} {mode}" for k, mode in enumerate(law.modes))
    return (
        '    <ScalarVariable name="mode" valueReference="0" causality="input" '
        f'variability="discrete" description={quoteattr(f"controller in force: {modes}")}>'
        '<Integer start="0"/></ScalarVariable>\n'
    )


def _real(variable: Variable) -> str:
    begins = ' start="0"' if variable.causality == "input" else ""
    initial = "" if begins else ' initial="calculated"'
    return (
        f'    <ScalarVariable name="{variable.name}" valueReference="{variable.reference}" '
        f'causality="{variable.causality}" variability="discrete"{initial} '
        f"description={quoteattr(variable.meaning)}>"
        f"<Real unit={quoteattr(variable.unit)}{begins}/></ScalarVariable>\n"
    )


_VALID = (
    '    <ScalarVariable name="valid" valueReference="0" causality="output" '
    'variability="discrete" initial="calculated" description="whether the step was computed">'
    "<Boolean/></ScalarVariable>\n"
)


def _unknown(variables: Variables) -> str:
    """List the outputs by their places; the mode comes first, and whether a step is valid last."""
    places = [v.reference + 2 for v in variables.reals if v.causality == "output"]
    places.append(len(variables.reals) + 2)
    return "".join(f'<Unknown index="{place}" dependencies=""/>' for place in places)
