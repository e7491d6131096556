import hashlib
import json
from types import SimpleNamespace

import pytest

from nrs_design.assurance.build import read_build
from nrs_design.errors import DataError

PROGRAM = {"arm.c": b"int x;", "arm.h": b"#pragma once", "arm_test.c": b"test"}
CERTIFICATE = SimpleNamespace(spec_name="arm", spec_sha256="1" * 64, id="2" * 64)
# As `nrs_design.exporters.binary_record` writes it.
RECORD = {
    "schema": "nrs-design/binary/1",
    "package": "1.0.0",
    "spec": {"name": "arm", "sha256": "1" * 64},
    "certificate": "2" * 64,
    "compiler": {"version": "gcc 13.2", "target": "arm-none-eabi"},
    "compile": ["arm-none-eabi-gcc", "-O2"],
    "link": [],
    "run": ["qemu-system-arm", "-M"],
    "result": "1000 of 1000 steps",
    "compared": {name: hashlib.sha256(text).hexdigest() for name, text in PROGRAM.items()},
    "compiled": {"arm.o": "3" * 64},
    "not_compared": ["silicon: an emulator ran it"],
}


def read(tmp_path, **changes):
    path = tmp_path / "arm.binary.json"
    path.write_text(json.dumps(RECORD | changes))
    return read_build(path, CERTIFICATE, PROGRAM)


def test_a_build_of_these_sources(tmp_path):
    found = read(tmp_path)
    assert found.others == ()
    assert found.said == "1000 of 1000 steps; gcc 13.2; run by qemu-system-arm"
    assert read(tmp_path, run=[]).said.endswith("; run where it was compiled")
    assert found.record.compiled == {"arm.o": "3" * 64}
    assert found.content == json.dumps(RECORD).encode()


def test_a_build_of_other_sources_is_told(tmp_path):
    assert read(tmp_path, compared={"arm.c": "0" * 64}).others == ("arm.c", "arm.h")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"spec": {"name": "arm", "sha256": "4" * 64}}, "another spec or certificate"),
        ({"certificate": "4" * 64}, "another spec or certificate"),
        ({"schema": "nrs-design/binary/2"}, "is no record of a build: schema"),
        ({"compiled": ["arm.o"]}, "is no record of a build: compiled"),
    ],
)
def test_what_is_about_something_else_is_refused(tmp_path, changes, said):
    with pytest.raises(DataError, match=said):
        read(tmp_path, **changes)


def test_what_is_no_json_is_refused(tmp_path):
    (tmp_path / "arm.binary.json").write_text("{")
    with pytest.raises(DataError, match="is no record of a build: its text"):
        read_build(tmp_path / "arm.binary.json", CERTIFICATE, PROGRAM)


def test_a_design_without_a_program_has_no_build(tmp_path):
    with pytest.raises(DataError, match="this design has none here"):
        read_build(tmp_path / "arm.binary.json", CERTIFICATE, {})
