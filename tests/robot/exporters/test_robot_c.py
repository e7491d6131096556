"""Exported motion control: compilers agree with the replica, sizes, and what the files say."""

import re
from dataclasses import replace

import pytest

from nrs_design.errors import DesignError
from nrs_design.robot.exporters.c import (
    PURPOSES,
    UNPROVED,
    header_text,
    names_of,
    render,
    source_text,
)
from nrs_design.robot.exporters.robot_tree import RobotExport
from nrs_design.robot.models import build_robot
from tests.exporters.programs import (
    CORTEX,
    STRICT,
    built,
    check_with_misra,
    compiler,
    emulated,
    run,
)
from tests.robot.exporters.robot_programs import program, wild

COUNT = 10_000
# Instructions of an emulated Cortex-M4F at most, -O2.
SIZES = {
    "base": 170,
    "pd": 110,
    "pd_gravity": 256,
    "computed_torque": 415,
    "inverse_dynamics": 990,
}


@pytest.fixture(scope="session")
def exported(loaded):
    return RobotExport(loaded, build_robot(loaded.spec), "robot.nrs.yaml")


def written(folder, exported, laws, count):
    """Write header, source and a program that runs so many cases of each law."""
    name = exported.loaded.spec.name
    (folder / f"{name}.h").write_text(header_text(exported, laws))
    (folder / "laws.c").write_text(source_text(exported, laws))
    (folder / "test.c").write_text(program(name, laws, wild(laws, count)))


@pytest.mark.parametrize(
    ("count", "levels"),
    [(500, ("-O2",)), pytest.param(COUNT, ("-O0", "-O2", "-O3"), marks=pytest.mark.slow)],
)
def test_host_compilers_agree_with_the_replica(tmp_path, exported, control_laws, count, levels):
    """Quotients and square roots, too, and no function of libm but that."""
    gcc = compiler()
    written(tmp_path, exported, control_laws, count)
    built(gcc, *STRICT, "-O0", "-c", tmp_path / "test.c", "-o", tmp_path / "test.o")
    for level in levels:
        made = tmp_path / f"test{level}"
        objects = (tmp_path / "laws.c", tmp_path / "test.o", "-lm", "-o", made)
        built(gcc, *STRICT, level, *objects)
        assert run(made).stdout == "0 cases differ\n"


@pytest.mark.slow
@pytest.mark.parametrize("law", SIZES)
def test_an_emulated_cortex_agrees_with_the_replica(tmp_path, exported, control_laws, law):
    """One law at a time: the cases of all are more than its memory holds."""
    written(tmp_path, exported, {law: control_laws[law]}, COUNT)
    said = emulated(tmp_path, tmp_path / "laws.c", tmp_path / "test.c")
    assert said == "0: 0 cases differ\n"


def test_sizes_on_a_cortex(tmp_path, exported, control_laws):
    """Straight-line code: an instruction of the listing is one of a step, at most."""
    gcc, listing = compiler("arm-none-eabi-gcc"), compiler("arm-none-eabi-objdump")
    written(tmp_path, exported, control_laws, 1)
    flags = (*CORTEX, *STRICT, "-O2", "-fno-math-errno", "-c")
    built(gcc, *flags, tmp_path / "laws.c", "-o", tmp_path / "laws.o")
    text = run(listing, "-d", tmp_path / "laws.o").stdout
    found = instructions(text)
    for law, most in SIZES.items():
        assert 50 < found[f"{names_of('neuroboscope', law).lower}_step"] <= most
    # Of libm and of doubles there is nothing.
    symbols = run(compiler("arm-none-eabi-nm"), "-u", tmp_path / "laws.o").stdout
    assert symbols == ""


def instructions(listing):
    """Count the instructions of every function."""
    found, name = {}, None
    for line in listing.splitlines():
        if head := re.match(r"[0-9a-f]+ <(\w+)>:", line):
            found[name := head[1]] = 0
        elif re.match(r"\s+[0-9a-f]+:\t[0-9a-f ]+\t(?!\.word)", line):
            found[name] += 1
    return found


@pytest.mark.slow
def test_cppcheck_with_misra_is_content(tmp_path, exported, control_laws):
    written(tmp_path, exported, control_laws, 1)
    check_with_misra(tmp_path / "laws.c")


def test_files_say_that_nothing_is_proved(exported, control_laws):
    for text in (header_text(exported, control_laws), source_text(exported, control_laws)):
        words = " ".join(text.replace("\n *", " ").split())
        assert text.startswith("/* nrs-design C ")
        assert f"verdict: UNPROVED: {UNPROVED}" in words
        assert "certificate: none" in words
        assert exported.loaded.sha256 in words
        assert "\n * spec file: robot.nrs.yaml\n" in text
        assert "sample time: 2 ms" in words
    header = header_text(exported, control_laws)
    assert all(f"{names_of('neuroboscope', law).lower}_step(" in header for law in PURPOSES)


@pytest.mark.slow
def test_a_robot_without_control_has_none_to_export(exported):
    spec = exported.loaded.spec.model_copy(update={"control": None})
    with pytest.raises(DesignError, match="no `control`"):
        render(replace(exported, loaded=replace(exported.loaded, spec=spec)))
