"""The C around a law for co-simulation: all functions of the standard, each once, and no gap."""

import re

import pytest

from nrs_design.exporters.c import header_text
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.fmu_source import wrapper_text
from nrs_design.exporters.program import Program
from tests.exporters.programs import LAWS, STRICT, built, compiler

# FMI 2.0: what every model has, and what those for co-simulation have besides.
FUNCTIONS = (
    "GetTypesPlatform",
    "GetVersion",
    "SetDebugLogging",
    "Instantiate",
    "FreeInstance",
    "SetupExperiment",
    "EnterInitializationMode",
    "ExitInitializationMode",
    "Terminate",
    "Reset",
    "GetReal",
    "GetInteger",
    "GetBoolean",
    "GetString",
    "SetReal",
    "SetInteger",
    "SetBoolean",
    "SetString",
    "GetFMUstate",
    "SetFMUstate",
    "FreeFMUstate",
    "SerializedFMUstateSize",
    "SerializeFMUstate",
    "DeSerializeFMUstate",
    "GetDirectionalDerivative",
    "SetRealInputDerivatives",
    "GetRealOutputDerivatives",
    "DoStep",
    "CancelStep",
    "GetStatus",
    "GetRealStatus",
    "GetIntegerStatus",
    "GetBooleanStatus",
    "GetStringStatus",
)


def text_of(shape, export):
    names = CNames(export.record.spec.name)
    return wrapper_text(Program(export.record, LAWS[shape], names), "{some-guid}", "0.002")


def test_every_function_of_the_standard_is_there_once(sampled_export):
    found = re.findall(r"\bFMI2\(fmi2(\w+)\)\(", text_of("limits", sampled_export))
    assert sorted(found) == sorted(FUNCTIONS)


@pytest.mark.parametrize("shape", LAWS)
def test_no_place_is_left_open(sampled_export, shape):
    """The GUID, the sample time and every variable are in; inputs come first and may be set."""
    law, text = LAWS[shape], text_of(shape, sampled_export)
    assert "@" not in text
    assert 'strcmp(guid, "{some-guid}")' in text
    assert "#define PERIOD 0.002\n" in text
    places = re.findall(r"case (\d+)U:\n        return &m->([\w.]+);", text)
    wanted = [f"in.{v.name}" for v in law.inputs] + [f"out.{name}" for name in law.outputs]
    wanted += [f"state.{v.name}" for v in law.states]
    assert places == [(str(k), place) for k, place in enumerate(wanted)]
    assert f"at[k] >= {len(law.inputs)}U" in text
    assert all(f"m->in.{v.name} = 0.0F;" in text for v in law.inputs)


def test_it_compiles_without_a_warning(tmp_path, sampled_export):
    gcc, names = compiler(), CNames(sampled_export.record.spec.name)
    header = header_text(sampled_export.record, LAWS["limits"], names)
    (tmp_path / f"{names.spec}.h").write_text(header)
    (tmp_path / "fmu.c").write_text(text_of("limits", sampled_export))
    built(gcc, *STRICT, "-c", tmp_path / "fmu.c", "-o", tmp_path / "fmu.o")
