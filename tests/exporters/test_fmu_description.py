"""What the description of a co-simulation model says of its variables."""

from xml.etree import ElementTree

import pytest

from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.fmu_description import description
from nrs_design.exporters.program import Program
from tests.exporters.programs import LAWS


@pytest.fixture(params=LAWS)
def law(request):
    return LAWS[request.param]


@pytest.fixture
def described(law, sampled_export):
    program = Program(sampled_export.record, law, CNames("a.b"))
    return ElementTree.fromstring(description(program, "{guid}", "0.002"))


def test_every_variable_of_a_step(law, described):
    found = {v.get("name"): v for v in described.iter("ScalarVariable")}
    inputs = ["mode", *(v.name for v in law.inputs)]
    states = [f"state.{v.name}" for v in law.states]
    assert [*found] == [*inputs, *law.outputs, *states, "valid"]
    for kind, names in (("input", inputs), ("output", [*law.outputs, "valid"]), ("local", states)):
        assert {found[name].get("causality") for name in names} == {kind}
    for value in law.inputs:
        (real,) = found[value.name]
        assert real.get("unit") == value.unit
        assert found[value.name].get("description") == value.meaning


def test_outputs_are_where_the_structure_says(law, described):
    variables = [v.get("name") for v in described.iter("ScalarVariable")]
    for part in ("Outputs", "InitialUnknowns"):
        places = [int(u.get("index")) for u in described.find(f"ModelStructure/{part}")]
        assert [variables[place - 1] for place in places] == [*law.outputs, "valid"]


def test_names_verdict_and_step(described):
    assert described.get("description").startswith("PROVED: ")
    assert described.find("CoSimulation").get("modelIdentifier") == "nrs_a_b"
    assert [f.get("name") for f in described.iter("File")] == ["fmu.c", "a.b.c"]
    assert described.find("DefaultExperiment").get("stepSize") == "0.002"


def test_turns_per_minute_are_turned_into_radians(described):
    """FMI: what is in base units is factor times what is in this unit; 60 rpm are 2 pi rad/s."""
    (rpm,) = [unit[0] for unit in described.iter("Unit") if unit.get("name") == "rpm"]
    assert 60 * float(rpm.get("factor")) == pytest.approx(6.283185307179586, rel=1e-15)
