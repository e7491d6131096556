"""Conformance vectors: what they hold, that they never change, and that their tests find faults."""

import csv
import io
import json
import re
import struct
import sys
from collections import Counter

import numpy as np
import pytest

from nrs_design.controllers.replica import step
from nrs_design.exporters.formats.vectors import csv_text, make_vectors, vectors_text
from tests.exporters.programs import LAWS, compiler, run, source_file, write_formats

# An implementation that has nothing in common with the package but the formulas: each operation in
# double precision, then rounded once to single precision.
PYTHON = source_file("law.py.txt")


@pytest.mark.parametrize("shape", LAWS)
def test_cases_reach_every_corner(shape):
    """Every kind of number that a memory can hold, in inputs and states; most steps are valid."""
    vectors = make_vectors(LAWS[shape])
    valid = vectors.rows[:, vectors.columns.index("valid")]
    assert 0.6 < valid.mean() < 0.95
    assert Counter(vectors.rows[:, 0])[len(LAWS[shape].modes)] > 10
    for i, name in enumerate(vectors.columns):
        if name not in ("mode", "valid", *LAWS[shape].outputs) and not name.startswith("after."):
            numbers = vectors.rows[:, i].view(np.float32)
            assert np.isnan(numbers).any()
            assert np.isinf(numbers).any()
            assert ((numbers != 0) & (np.abs(numbers) < np.finfo(np.float32).tiny)).any()


def test_cases_saturate_and_do_not():
    """In both directions, the command of the hand and that of the motor."""
    law = LAWS["limits"]
    vectors = make_vectors(law)
    valid = vectors.rows[:, vectors.columns.index("valid")] == 1
    for name, limit in (("velocity_command", "velocity_limit"), ("command", "command_limit")):
        numbers = vectors.rows[valid, vectors.columns.index(name)].view(np.float32)
        largest = float(law.coefficient[limit].values[0])
        for beyond in (numbers >= largest, numbers <= -largest, np.abs(numbers) < largest):
            assert beyond.sum() > 10


def test_an_invalid_step_keeps_the_bits_of_the_state():
    law = LAWS["inertia"]
    given = {v.name: np.array([0, 0, 0], np.float32) for v in law.values}
    given["velocity"] = np.array([0x7F800001, 0xFFC12345, 0], np.uint32).view(np.float32)
    result = step(law, np.array([0, 1, 2], np.uint32), given)
    assert not result.valid.any()
    assert (result.states["velocity"].view(np.uint32) == given["velocity"].view(np.uint32)).all()
    assert not result.outputs["command"].any()


def test_json_and_csv_hold_the_same():
    law = LAWS["limits"]
    vectors = make_vectors(law, 50)
    document = json.loads(vectors_text(law, vectors, ("one", "two")))
    lines = csv_text(vectors, ("one", "two")).splitlines()
    assert lines[:3] == ["# nrs-design vectors", "# one", "# two"]
    rows = [*csv.reader(io.StringIO("\n".join(lines[3:])))]
    assert rows[0] == document["columns"] == list(vectors.columns)
    assert rows[1:] == [[str(entry) for entry in case] for case in document["cases"]]
    assert document["schema"] == "nrs-design/vectors/1"
    assert document["about"] == ["one", "two"]
    assert document["units"]["command"] == "rpm"
    assert {*document["inputs"], *document["outputs"], "mode", "valid"} < set(document["columns"])
    (mode, angle, *_) = document["cases"][0]
    assert mode == vectors.rows[0, 0]
    assert struct.pack(">I", vectors.rows[0, 1]).hex() == angle


@pytest.mark.slow
def test_exported_tests_pass_as_they_are(tmp_path, sampled_export):
    compiler("cc")
    write_formats(tmp_path, sampled_export, ("c", "vectors"))
    assert "3 passed, 1 skipped" in pytest_in(tmp_path, "test")
    source = tmp_path / f"{sampled_export.record.spec.name}.c"
    source.write_text(source.read_text().replace("proportional + ", "proportional - "))
    assert "3 failed" in pytest_in(tmp_path, "exported_c")


@pytest.mark.slow
def test_any_implementation_in_python_can_be_tested(tmp_path, sampled_export, monkeypatch):
    write_formats(tmp_path, sampled_export, ("c", "vectors"))
    header = tmp_path / f"{sampled_export.record.spec.name}.h"
    own = f"NRS_{sampled_export.record.spec.name.replace('-', '_').upper()}_"
    found = re.findall(rf"#define {own}(\w+) (\S+)F ", header.read_text())
    numbers = {name: float.fromhex(text) for name, text in found}
    limits = {name[4:].lower(): n for name, n in numbers.items() if name.startswith("MAX_")}
    (tmp_path / "mine.py").write_text(PYTHON.format(numbers=numbers, limits=limits))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("NRS_STEP", "mine:step")
    assert "1 passed" in pytest_in(tmp_path, "python")
    numbers["A"] = float(np.nextafter(np.float32(numbers["A"]), np.float32(1)))
    (tmp_path / "other.py").write_text(PYTHON.format(numbers=numbers, limits=limits))
    monkeypatch.setenv("NRS_STEP", "other:step")
    assert "1 failed" in pytest_in(tmp_path, "python")


def pytest_in(folder, chosen):
    command = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-k", chosen)
    return run(sys.executable, *command, "--rootdir", folder, folder).stdout
