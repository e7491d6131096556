"""A spec that names a robot: its bounds are read, and refused where they are not of that robot."""

import json
import shutil
from fractions import Fraction

import pytest

from nrs_design.errors import AssemblyError, SpecError
from nrs_design.spec import parse_spec, read_spec
from nrs_design.spec.meaning import hash_meaning
from nrs_design.spec.robot_bounds import SCHEMA, UNITS, bounds_file, content_id, identity_of
from nrs_design.switched.coupled import AxesCoupling
from tests.spec.test_coupling import LOADED
from tests.support import ROOT

COUPLING = "coupling: {robot: robots/arm.nrs.yaml, speed: 2 rad/s, gravity_compensated: at-rest}\n"
SPACE = {"phi_deg": "13", "psi_deg": "18", "d_mm": ["155", "235"]}
NUMBERS = {
    "lightest": "0.004",
    "heaviest": "0.28",
    "velocity_torques": "0.3",
    "gravity_gradient": "7",
}


def found(key, value):
    """Return what was found at poses, in a file whose other bounds are just that."""
    return {"found": {k: {"value": value if k == key else v} for k, v in NUMBERS.items()}}


@pytest.fixture
def folder(tmp_path):
    """A spec, the robot that it names, and bounds of that."""
    robot = tmp_path / "robots/arm.nrs.yaml"
    robot.parent.mkdir()
    shutil.copy(ROOT / "specs/robots/neuroboscope.nrs.yaml", robot)
    (tmp_path / "axes.nrs.yaml").write_text(f"{LOADED}{COUPLING}contact: kept\n")
    write(robot, {})
    return tmp_path


def write(robot, changes, /, **more):
    document = {
        "schema": SCHEMA,
        "robot": dict(zip(("name", "sha256"), identity_of(robot), strict=True)),
        "workspace": SPACE,
        "bounds": NUMBERS | changes,
        "units": UNITS,
        "found": {key: {"value": value} for key, value in (NUMBERS | changes).items()},
    } | more
    text = json.dumps(document | {"id": content_id(document)})
    bounds_file(robot).write_text(text)


def read(folder):
    return read_spec(folder / "axes.nrs.yaml")


def test_bounds_become_those_of_the_axes(folder):
    coupling = AxesCoupling.of(read(folder).spec.coupling, Fraction(1))
    assert [float(b) for b in (coupling.lightest, coupling.heaviest)] == [0.004, 0.28]
    assert float(coupling.coriolis) == 0.6
    assert coupling.gravity_gradient == 7
    assert "SHA-256" in coupling.source
    assert "|phi| <= 13 deg" in coupling.poses
    assert "assembly mode" in coupling.source
    assert coupling.source.startswith("taken on trust from the file of bounds")
    assert read(folder).spec.coupling.bounds.id in coupling.source
    assert "friction" in coupling.source
    assert "stretched by 2" in coupling.scaled(Fraction(2)).source


def test_the_bounds_are_a_part_of_what_the_spec_says(folder):
    before = read(folder)
    write(folder / "robots/arm.nrs.yaml", {"heaviest": "0.29"})
    after = read(folder)
    assert before.text == after.text
    assert before.sha256 != after.sha256


def test_a_robot_that_has_changed_makes_its_bounds_stale(folder):
    robot = folder / "robots/arm.nrs.yaml"
    robot.write_text(robot.read_text().replace("mass: 797.2 g", "mass: 897.2 g"))
    with pytest.raises(SpecError, match="has changed since its bounds were computed") as caught:
        read(folder)
    assert caught.value.path == folder / "axes.nrs.yaml"
    assert caught.value.line is not None
    assert "robot bounds" in caught.value.remedy


def test_comments_of_a_robot_may_change(folder):
    robot = folder / "robots/arm.nrs.yaml"
    before = read(folder).sha256
    robot.write_text(f"# A comment.\n{robot.read_text()}")
    assert read(folder).sha256 == before


def test_an_altered_file_is_refused(folder):
    file = folder / "robots/arm.bounds.json"
    file.write_text(file.read_text().replace('"0.28"', '"0.18"'))
    with pytest.raises(SpecError, match="it has been altered"):
        read(folder)


@pytest.mark.parametrize(
    ("changes", "more", "message"),
    [
        ({"heaviest": "0.001"}, {}, "the lightest is above the heaviest"),
        ({"velocity_torques": "-1"}, {}, "a bound is negative"),
        ({"heaviest": "much"}, {}, "not bounds of a robot"),
        ({}, {"schema": "nrs-design/robot-bounds/9"}, "its schema is not"),
        ({}, {"workspace": []}, "not bounds of a robot"),
        ({}, {"units": {**UNITS, "heaviest": "g*m^2"}}, "its units are not those of SI"),
        ({}, {"workspace": SPACE | {"phi_deg": "170"}}, "are not between 0 and 90 deg"),
        ({}, {"workspace": SPACE | {"psi_deg": "18 deg, or more"}}, "not bounds of a robot"),
        ({}, {"workspace": SPACE | {"d_mm": ["235", "155"]}}, "or its depths are no range"),
        ({"heaviest": float("nan")}, {}, "not bounds of a robot"),
        ({"gravity_gradient": "inf"}, {}, "not bounds of a robot"),
        ({}, {"found": {}}, "not bounds of a robot"),
        ({}, found("lightest", "0.003999"), "bounded by 0.004, and 0.003999 was found"),
        ({}, found("heaviest", "0.28001"), "bounded by 0.28, and 0.28001 was found"),
        ({}, found("velocity_torques", "1"), "velocity torques is said to be bounded by 0.3"),
        ({}, found("gravity_gradient", "7.1"), "gravity gradient is said to be bounded by 7"),
    ],
)
def test_files_that_are_none(folder, changes, more, message):
    write(folder / "robots/arm.nrs.yaml", changes, **more)
    with pytest.raises(SpecError, match=message):
        read(folder)


@pytest.mark.parametrize(
    ("key", "text"),
    [
        ("name", "arm.\nGravity is absent"),
        ("name", "arm, whose bounds were measured"),
        ("name", 3),
        ("sha256", 64 * "g"),
        ("sha256", "0" * 64 + " and more"),
    ],
)
def test_what_stands_in_sentences_is_a_name_and_a_hash(folder, key, text):
    robot = folder / "robots/arm.nrs.yaml"
    name, sha256 = identity_of(robot)
    write(robot, {}, robot={"name": name, "sha256": sha256} | {key: text})
    with pytest.raises(SpecError, match="not bounds of a robot"):
        read(folder)


def test_the_name_is_that_of_the_robot(folder):
    robot = folder / "robots/arm.nrs.yaml"
    write(robot, {}, robot={"name": "another", "sha256": identity_of(robot)[1]})
    with pytest.raises(SpecError, match="has changed since its bounds were computed"):
        read(folder)


def test_missing_files(folder):
    (folder / "robots/arm.bounds.json").unlink()
    with pytest.raises(SpecError, match="cannot be read") as caught:
        read(folder)
    assert "nrs-design robot bounds" in caught.value.remedy
    (folder / "robots/arm.nrs.yaml").unlink()
    with pytest.raises(SpecError, match="there is no robot spec"):
        read(folder)


def test_a_text_alone_has_no_robot():
    spec = parse_spec(LOADED + "coupling: {robot: arm.nrs.yaml}\n")
    with pytest.raises(AssemblyError, match="this is a text"):
        AxesCoupling.of(spec.coupling, Fraction(1))


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ("robot: a.nrs.yaml, inertia: [0 kg*m^2, 1 kg*m^2]", "inertia is that of the robot"),
        ("robot: a.nrs.yaml, gravity_gradient: 7 N*m/rad", "gravity_gradient is that of the robot"),
        ("gravity_compensated: at-rest", "is for the bounds of a robot"),
        ("speed: 1 rad/s", "neither robot nor inertia"),
    ],
)
def test_what_is_computed_is_not_declared(said, message):
    with pytest.raises(SpecError, match=message):
        parse_spec(f"{LOADED}coupling: {{{said}}}\n")


def test_hash_of_the_meaning_is_that_of_the_file_where_no_robot_is_named(tmp_path):
    file = tmp_path / "alone.nrs.yaml"
    file.write_text(LOADED)
    spec = read_spec(file)
    assert (spec.spec.name, spec.sha256) == identity_of(file)
    assert len(hash_meaning({"a": "b"})) == 64
