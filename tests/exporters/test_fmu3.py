"""The model by FMI 3.0: what FMPy and the headers of the standard say of it, and every bit."""

import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

from nrs_design.controllers.replica import step
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.cosimulation import (
    FMI2,
    FMI3,
    contents,
    description,
    guid_of,
    library_of,
    packed,
    variables_of,
    wrapper_text,
)
from nrs_design.exporters.deployed_model import model_differences
from nrs_design.exporters.formats.fmu3 import remarks, render
from nrs_design.exporters.formats.vectors import make_vectors
from nrs_design.exporters.program import Program, program_of
from tests.exporters.programs import LAWS, STRICT, built, compiler
from tests.exporters.programs import run as run_program
from tests.support import thinned

T = 0.002
STANDARD = Path(fmpy.__file__).parent


def program(law, export):
    return Program(export.record, law, CNames(export.record.spec.name))


@pytest.fixture(scope="module")
def model(sampled_export, tmp_path_factory):
    """Compile, describe and unpack the model of a law once."""

    @cache
    def of(law):
        folder = tmp_path_factory.mktemp("fmu3")
        file = folder / "model.fmu"
        entries = contents(program(LAWS[law], sampled_export), FMI3, compiler("cc"))
        file.write_bytes(packed(entries))
        assert validate_fmu(str(file)) == []
        return fmpy.read_model_description(file), fmpy.extract(file, unzipdir=folder / "model")

    return of


@pytest.fixture
def opened(model):
    """Open the model of a law as an importer does; it is closed at the end."""
    slaves = []

    def of(law):
        told, folder = model(law)
        identity = {"guid": told.guid, "modelIdentifier": told.coSimulation.modelIdentifier}
        slave = FMU3Slave(unzipDirectory=folder, instanceName="law", **identity)
        slave.instantiate()
        slaves.append(slave)
        return slave, {v.name: v.valueReference for v in told.modelVariables}

    yield of
    for slave in slaves:
        slave.freeInstance()


def run(slave, at, angle=0.0, begin=0.0):
    slave.enterInitializationMode(startTime=begin)
    slave.setFloat32([at["angle"]], [angle])
    slave.exitInitializationMode()


@pytest.mark.parametrize("shape", thinned(sorted(LAWS, key=lambda shape: shape != "limits"), 1))
def test_every_bit_is_that_of_the_replica(opened, shape):
    """1,000 steps in a row, with inputs that are not numbers, infinite or subnormal, too."""
    law = LAWS[shape]
    slave, at = opened(shape)
    run(slave, at)
    vectors = make_vectors(law)
    given = {v.name: vectors.rows[:, vectors.columns.index(v.name)] for v in law.inputs}
    modes = vectors.rows[:, 0]
    state = {value.name: np.zeros(1, np.float32) for value in law.states}
    outputs = [at[name] for name in (*law.outputs, *(f"state.{name}" for name in state))]
    valid = 0
    for k, mode in enumerate(modes):
        now = {name: bits[k : k + 1].view(np.float32) for name, bits in given.items()}
        slave.setInt64([at["mode"]], [int(mode)])
        slave.setFloat32([at[name] for name in now], [float(x[0]) for x in now.values()])
        assert slave.doStep(k * T, T) == (False, False, False, pytest.approx((k + 1) * T))
        result = step(law, modes[k : k + 1], now | state)
        state = {name: result.states[name] for name in state}
        wanted = np.concatenate([*result.outputs.values(), *state.values()])
        found = np.array(slave.getFloat32(outputs), np.float32)
        assert (found.view(np.uint32) == wanted.view(np.uint32)).all()
        assert slave.getBoolean([at["valid"]]) == [bool(result.valid[0])]
        valid += int(result.valid[0])
    assert 300 < valid < 950
    assert slave.getFloat64([at["time"]]) == [pytest.approx(1000 * T)]


def test_a_simulator_runs_it_as_it_runs_the_other_version(tmp_path, sampled_export):
    """Half a second of a push with 0.1 N m from 0.2 rad: the same numbers by both versions."""
    rows = []
    for interface in (FMI2, FMI3):
        file = tmp_path / f"{interface.version}.fmu"
        law = program(LAWS["limits"], sampled_export)
        file.write_bytes(packed(contents(law, interface, compiler("cc"))))
        rows.append(
            fmpy.simulate_fmu(
                file,
                stop_time=0.5,
                start_values={"angle": 0.02, "torque": 0.1},
                output=["command", "state.reference"],
            )
        )
    for name in ("command", "state.reference"):
        assert len(rows[0][name]) == 251
        assert len({*rows[0][name]}) > 100
        assert np.array_equal(rows[0][name], rows[1][name])


def test_it_starts_at_rest_and_again_after_a_reset_at_any_time(opened):
    slave, at = opened("inertia")
    run(slave, at, 0.25)
    assert slave.getFloat32([at["state.reference"], at["command"]]) == [0.25, 0.0]
    slave.setFloat32([at["torque"]], [0.5])
    slave.doStep(0.0, T)
    slave.reset()
    run(slave, at, 0.5, begin=7.0)
    assert slave.getFloat32([at["state.reference"], at["state.velocity"]]) == [0.5, 0.0]
    slave.doStep(7.0, 2 * T)


@pytest.mark.parametrize("mode", [-1, 2**32, 2**63 - 1, 2])
def test_a_mode_that_there_is_not_is_no_other_one(opened, mode):
    slave, at = opened("inertia")
    run(slave, at)
    slave.setInt64([at["mode"]], [mode])
    slave.doStep(0.0, T)
    assert slave.getBoolean([at["valid"]]) == [False]


@pytest.mark.parametrize(
    ("now", "length"), [(0.0, 1.5 * T), (0.0, 0.0), (0.0, float("nan")), (T / 2, T)]
)
def test_steps_that_no_clock_makes_are_refused(opened, now, length):
    slave, at = opened("inertia")
    with pytest.raises(FMICallException):
        slave.doStep(0.0, T)
    run(slave, at)
    with pytest.raises(FMICallException):
        slave.doStep(now, length)


def test_what_is_no_input_or_not_there_is_refused(opened):
    slave, at = opened("inertia")
    for name in ("command", "state.reference"):
        with pytest.raises(FMICallException):
            slave.setFloat32([at[name]], [1.0])
    for call in (
        lambda: slave.getFloat32([99]),
        lambda: slave.getFloat64([at["angle"]]),
        lambda: slave.getUInt32([at["mode"]]),
        lambda: slave.setBoolean([at["valid"]], [True]),
        lambda: slave.setClock([at["valid"]], [True]),
        slave.getFMUState,
    ):
        with pytest.raises(FMICallException):
            call()


def test_another_token_event_mode_and_other_kinds_of_models_are_refused(model):
    told, folder = model("inertia")
    identifier = told.coSimulation.modelIdentifier
    told_why = []

    def log(environment, status, category, message):
        told_why.append(message.decode())

    for token, events in (("{other}", False), (told.guid, True)):
        slave = FMU3Slave(
            unzipDirectory=folder, instanceName="x", guid=token, modelIdentifier=identifier
        )
        with pytest.raises(Exception, match="nstantiate"):
            slave.instantiate(eventModeUsed=events, logMessage=log)
    assert "token is of another model" in told_why[0]
    assert "no event mode" in told_why[1]


@pytest.fixture
def sources(tmp_path, sampled_export):
    for name, content in contents(program(LAWS["limits"], sampled_export), FMI3, None).items():
        if name.startswith("sources/"):
            (tmp_path / name.removeprefix("sources/")).write_bytes(content)
    return tmp_path


def test_it_keeps_the_headers_of_the_standard(sources):
    """Compiled below them, every function must have their types; none may be missing."""
    (sources / "all.c").write_text('#include "fmi3Functions.h"\n#include "fmi3.c"\n')
    own = [flag for flag in STRICT if flag not in ("-pedantic", "-Wpedantic")]
    headers = f"-isystem{STANDARD / 'c-code'}"
    built(compiler(), *own, headers, "-c", sources / "all.c", "-o", sources / "all.o")
    declared = re.findall(
        r"FMI3_Export fmi3(\w+?)TYPE", (STANDARD / "c-code/fmi3Functions.h").read_text()
    )
    assert len(declared) > 60
    compiled = (sources / "all.o").read_bytes()
    assert [name for name in declared if f"\0fmi3{name}\0".encode() not in compiled] == []


def test_a_wrong_type_of_a_function_would_be_seen(sources):
    text = (sources / "fmi3.c").read_text()
    assert "fmi3UInt16 value[]" in text
    (sources / "fmi3.c").write_text(text.replace("fmi3UInt16 value[]", "fmi3Int16 value[]", 1))
    (sources / "all.c").write_text('#include "fmi3Functions.h"\n#include "fmi3.c"\n')
    done = run_program(compiler(), f"-isystem{STANDARD / 'c-code'}", "-c", sources / "all.c")
    assert "conflicting types" in done.stderr


def test_sources_compile_without_a_warning_and_with_names_of_their_own(sources):
    prefix = "-DFMI3_FUNCTION_PREFIX=mine_"
    built(compiler(), *STRICT, prefix, "-c", sources / "fmi3.c", "-o", sources / "fmi3.o")
    assert b"mine_fmi3DoStep" in (sources / "fmi3.o").read_bytes()


def test_how_sources_are_built_keeps_the_schema_of_the_standard(sources):
    from lxml import etree

    schema = etree.XMLSchema(file=str(STANDARD / "schema/fmi3/fmi3BuildDescription.xsd"))
    built_by = etree.parse(str(sources / "buildDescription.xml"))
    schema.assertValid(built_by)
    named = [item.get("name") for item in built_by.iter("SourceFile")]
    assert sorted(named) == sorted(path.name for path in sources.glob("*.c"))


@pytest.mark.parametrize("shape", LAWS)
def test_every_variable_of_a_step_has_its_own_number_and_its_unit(sampled_export, shape):
    law = LAWS[shape]
    described = ElementTree.fromstring(description(program(law, sampled_export), FMI3))
    found = {v.get("name"): v for v in described.find("ModelVariables")}
    assert len({v.get("valueReference") for v in found.values()}) == len(found)
    for value in variables_of(law):
        variable = found.pop(value.name)
        assert variable.tag == "Float32"
        assert int(variable.get("valueReference")) == value.reference
        wanted = (value.unit, value.causality, value.meaning)
        assert tuple(variable.get(key) for key in ("unit", "causality", "description")) == wanted
    assert {name: v.tag for name, v in found.items()} == {
        "time": "Float64",
        "mode": "Enumeration",
        "valid": "Boolean",
    }
    assert [item.get("name") for item in described.iter("Item")] == list(law.modes)
    assert described.get("instantiationToken") == guid_of(sampled_export.record)
    assert described.find("CoSimulation").get("fixedInternalStepSize") == "0.002"


def test_a_change_in_what_was_deployed_is_told(sampled_export):
    """Of source, number, description and library; none of what was exported."""
    file = render(sampled_export)[".fmi3.fmu"]
    assert remarks({".fmi3.fmu": file}) == ()
    assert [*model_differences(file, sampled_export)] == []
    entries = contents(program_of(sampled_export), FMI3, None)
    law = next(name for name in entries if re.search(r"/(?!fmi3).*\.c$", name))
    for name, old, new in (
        ("sources/fmi3.c", b"value[k] = *found;", b"value[k] = -*found;"),
        (law, b"error_before = error;", b"error_before = -error;"),
        ("modelDescription.xml", b'unit="rad"', b'unit="deg"'),
        ("sources/buildDescription.xml", b"-ffp-contract=off", b"-ffast-math"),
    ):
        assert old in entries[name], name
        changed = entries | {name: entries[name].replace(old, new, 1)}
        (told,) = model_differences(packed(changed), sampled_export)
        assert told.startswith(f"{name}: "), name
    library = library_of(program_of(sampled_export), FMI3)
    (told,) = model_differences(packed(entries | {library: b"\x7fELF"}), sampled_export)
    assert "is not what" in told


def test_no_place_is_left_open(sampled_export):
    text = wrapper_text(program(LAWS["limits"], sampled_export), FMI3)
    assert guid_of(sampled_export.record) in text
    assert "{{" not in text
    assert "{%" not in text
