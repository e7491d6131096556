"""The co-simulation model: what FMPy says of it, and every bit that it computes."""

import io
import zipfile
from dataclasses import replace
from functools import cache
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu

from nrs_design.controllers.replica import step
from nrs_design.errors import DesignError
from nrs_design.exporters import format_of
from nrs_design.exporters.formats.fmu import compiler as found_compiler
from nrs_design.exporters.formats.fmu import (
    contents,
    description,
    guid_of,
    packed,
    remarks,
    render,
    shared_library,
)
from nrs_design.exporters.program import Program
from nrs_design.exporters.self_test import draw_cases
from nrs_design.exporters.text import CNames
from tests.exporters.programs import LAWS, STRICT, built, compiler
from tests.support import thinned

T = 0.002


def program(law, export):
    return Program(export.record, law, CNames(export.record.spec.name))


@pytest.fixture(scope="module")
def model(sampled_export, tmp_path_factory):
    @cache
    def of(law):
        folder = tmp_path_factory.mktemp("fmu")
        file = folder / "model.fmu"
        file.write_bytes(packed(contents(program(LAWS[law], sampled_export), compiler("cc"))))
        described = fmpy.read_model_description(file)
        return described, fmpy.extract(file, unzipdir=folder / "model")

    return of


@pytest.fixture
def opened(model):
    slaves = []

    def of(law):
        told, folder = model(law)
        identity = {"guid": told.guid, "modelIdentifier": told.coSimulation.modelIdentifier}
        slave = FMU2Slave(unzipDirectory=folder, instanceName="law", **identity)
        slave.instantiate()
        slaves.append(slave)
        return slave, {v.name: v.valueReference for v in told.modelVariables}

    yield of
    for slave in slaves:
        slave.freeInstance()


def run(slave, at, angle=0.0):
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.setReal([at["angle"]], [angle])
    slave.exitInitializationMode()


@pytest.mark.parametrize("shape", LAWS)
def test_fmpy_finds_no_problem(tmp_path, sampled_export, shape):
    file = tmp_path / "x.fmu"
    file.write_bytes(packed(contents(program(LAWS[shape], sampled_export), None)))
    assert validate_fmu(str(file)) == []


@pytest.mark.parametrize("shape", thinned(sorted(LAWS, key=lambda shape: shape != "limits"), 1))
def test_every_bit_is_that_of_the_replica(opened, shape):
    """1,000 steps in a row, with inputs that are not numbers, infinite or subnormal, too."""
    law = LAWS[shape]
    slave, at = opened(shape)
    run(slave, at)
    cases = draw_cases(law)
    given = {v.name: cases.rows[:, cases.columns.index(v.name)] for v in law.inputs}
    modes = cases.rows[:, 0]
    state = {value.name: np.zeros(1, np.float32) for value in law.states}
    names = [f"state.{name}" for name in state]
    outputs = [at[name] for name in (*law.outputs, *names)]
    valid = 0
    for k, mode in enumerate(modes):
        now = {name: bits[k : k + 1].view(np.float32) for name, bits in given.items()}
        slave.setInteger([at["mode"]], [int(mode)])
        slave.setReal([at[name] for name in now], [float(x[0]) for x in now.values()])
        slave.doStep(k * T, T)
        result = step(law, modes[k : k + 1], now | state)
        state = {name: result.states[name] for name in state}
        wanted = np.concatenate([*result.outputs.values(), *state.values()])
        found = np.array(slave.getReal(outputs))
        assert (found.astype(np.float32).view(np.uint32) == wanted.view(np.uint32)).all()
        assert (found == found.astype(np.float32)).all()
        assert slave.getBoolean([at["valid"]]) == [int(result.valid[0])]
        valid += int(result.valid[0])
    assert 300 < valid < 950


def test_a_simulator_runs_it(tmp_path, sampled_export):
    """Beside FMPy nothing is needed; half a second of a push with 0.1 N m from 0.2 rad."""
    compiler("cc")
    file = tmp_path / "x.fmu"
    file.write_bytes(render(sampled_export)[".fmu"])
    assert remarks({".fmu": file.read_bytes()}) == ()
    rows = fmpy.simulate_fmu(
        file, stop_time=0.5, start_values={"angle": 0.2, "torque": 0.1}, output=["state.reference"]
    )
    assert len(rows) == 251
    reference = rows["state.reference"]
    assert reference[0] == np.float32(0.2)
    # The admittance moves away from the force at F/Bt, once its inertia is gone.
    gains = {g.name: g.float32 for g in sampled_export.record.controllers[0].gains}
    slope = (reference[-1] - reference[-101]) / (100 * T)
    assert slope == pytest.approx(-0.1 / gains["Bt"], rel=1e-3)


def test_it_starts_at_rest_where_the_joint_is_and_again_after_a_reset(opened):
    slave, at = opened("inertia")
    run(slave, at, 0.25)
    assert slave.getReal([at["state.reference"], at["command"]]) == [0.25, 0.0]
    slave.setReal([at["torque"]], [0.5])
    slave.doStep(0.0, T)
    slave.doStep(T, T)
    assert slave.getReal([at["state.velocity"]]) != [0.0]
    slave.reset()
    run(slave, at, 0.5)
    assert slave.getReal([at["state.reference"], at["state.velocity"]]) == [0.5, 0.0]


def test_a_long_communication_step_is_many_samples(opened):
    slave, at = opened("inertia")
    found = []
    for count in (1, 5):
        run(slave, at, 0.1)
        slave.setReal([at["torque"]], [0.2])
        for k in range(0, 10, count):
            slave.doStep(k * T, count * T)
        found.append(slave.getReal([at["command"], at["state.reference"], at["state.velocity"]]))
        slave.reset()
    assert found[0] == found[1]


@pytest.mark.parametrize(
    ("now", "length"),
    [(0.0, 1.5 * T), (0.0, 0.0), (0.0, -T), (0.0, float("nan")), (0.0, 1e300), (T / 2, T)],
)
def test_steps_that_no_clock_makes_are_refused(opened, now, length):
    slave, at = opened("inertia")
    run(slave, at)
    with pytest.raises(FMICallException):
        slave.doStep(now, length)


def test_what_is_no_input_is_not_set(opened):
    slave, at = opened("inertia")
    for name in ("command", "state.reference"):
        with pytest.raises(FMICallException):
            slave.setReal([at[name]], [1.0])
    with pytest.raises(FMICallException):
        slave.getReal([99])
    with pytest.raises(FMICallException):
        slave.doStep(0.0, T)


def test_another_model_is_not_started(tmp_path, sampled_export):
    """The guid of the description must be that of the program."""
    entries = contents(program(LAWS["inertia"], sampled_export), compiler("cc"))
    guid = guid_of(sampled_export.record).encode()
    entries["modelDescription.xml"] = entries["modelDescription.xml"].replace(guid, b"{other}")
    file = tmp_path / "x.fmu"
    file.write_bytes(packed(entries))
    with pytest.raises(Exception, match="nstantiate"):
        fmpy.simulate_fmu(file, stop_time=0.01)


def test_sources_compile_without_a_warning_and_with_names_of_their_own(tmp_path, sampled_export):
    entries = contents(program(LAWS["limits"], sampled_export), None)
    assert not [name for name in entries if name.startswith("binaries")]
    for name, content in entries.items():
        if name.startswith("sources/"):
            (tmp_path / name.removeprefix("sources/")).write_bytes(content)
    prefix = "-DFMI2_FUNCTION_PREFIX=mine_"
    built(compiler(), *STRICT, prefix, "-c", tmp_path / "fmu.c", "-o", tmp_path / "fmu.o")
    assert b"mine_fmi2DoStep" in (tmp_path / "fmu.o").read_bytes()


def test_the_guid_follows_from_spec_proof_and_period(sampled_export):
    record = sampled_export.record
    others = [
        record.model_copy(update=change)
        for change in (
            {"spec": record.spec.model_copy(update={"sha256": 64 * "0"})},
            {"proof": None},
            {"sample_time": record.sample_time.model_copy(update={"exact": "1"})},
        )
    ]
    assert len({guid_of(each) for each in (record, *others)}) == 4


def test_it_says_where_it_is_not_compiled(sampled_export, monkeypatch):
    monkeypatch.setattr("nrs_design.exporters.formats.fmu.compiler", lambda: None)
    files = render(sampled_export)
    (remark,) = remarks(files)
    assert "sources only" in remark
    with zipfile.ZipFile(io.BytesIO(files[".fmu"])) as archive:
        assert "sources/fmu.c" in archive.namelist()
        assert "only sources" in archive.read("documentation/index.html").decode()
    assert files[".fmu"].startswith(format_of("fmu").files[".fmu"])


def test_its_page_says_what_is_proved_and_what_is_not(sampled_export):
    bare = sampled_export.record.model_copy(update={"proof": None})
    text, unproved = (
        contents(program(LAWS["limits"], export), None)["documentation/index.html"].decode()
        for export in (sampled_export, replace(sampled_export, record=bare))
    )
    for words in ("one sample slower than the proof", "proves nothing", "0: insertion"):
        assert words in text
    assert "Taken for granted" in text
    assert "Taken for granted" not in unproved


@pytest.fixture(params=LAWS)
def law(request):
    return LAWS[request.param]


@pytest.fixture
def described(law, sampled_export):
    program = Program(sampled_export.record, law, CNames("a.b"))
    return ElementTree.fromstring(description(program))


def test_every_variable_of_a_step(law, described):
    found = {v.get("name"): v for v in described.iter("ScalarVariable")}
    inputs = ["mode", *(v.name for v in law.inputs)]
    states = [f"state.{v.name}" for v in law.states]
    assert [*found] == [*inputs, *law.outputs, *states, "valid"]
    for kind, names in (("input", inputs), ("output", [*law.outputs, "valid"]), ("local", states)):
        assert all(found[name].get("causality") == kind for name in names)
    for value in law.inputs:
        (real,) = found[value.name]
        assert real.get("unit") == value.unit
        assert found[value.name].get("description") == value.meaning


def test_names_verdict_step_and_the_unit_of_turns(described):
    """FMI: what is in base units is factor times what is in this unit; 60 rpm are 2 pi rad/s."""
    assert described.get("description").startswith("PROVED: ")
    assert described.find("CoSimulation").get("modelIdentifier") == "nrs_a_b"
    assert [f.get("name") for f in described.iter("File")] == ["fmu.c", "a.b.c"]
    assert described.find("DefaultExperiment").get("stepSize") == "0.002"
    (rpm,) = [unit[0] for unit in described.iter("Unit") if unit.get("name") == "rpm"]
    assert 60 * float(rpm.get("factor")) == pytest.approx(6.283185307179586, rel=1e-15)


SOURCES = {
    "x.h": "int twice(int n);\n",
    "x.c": '#include "x.h"\nint twice(int n) { return 2 * n; }\n',
}


def test_the_same_sources_are_the_same_bytes():
    cc = compiler("cc")
    first = shared_library(cc, SOURCES)
    assert first.startswith(b"\x7fELF")
    assert shared_library(cc, SOURCES) == first
    assert b"/tmp" not in first


def test_what_the_compiler_says_is_told():
    with pytest.raises(DesignError, match=r"does not compile the law: x\.c"):
        shared_library(compiler("cc"), {"x.c": "int main(\n"})


@pytest.mark.parametrize("other", [("Darwin", "arm64"), ("Linux", "aarch64"), ("Windows", "AMD64")])
def test_no_other_system_is_taken_for_linux_on_x86(monkeypatch, other):
    monkeypatch.setattr("platform.system", lambda: other[0])
    monkeypatch.setattr("platform.machine", lambda: other[1])
    assert found_compiler() is None
