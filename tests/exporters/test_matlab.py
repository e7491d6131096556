"""MAT-files, read back by SciPy and by GNU Octave."""

import re
import subprocess
from fractions import Fraction

import numpy as np
import pytest
import scipy.io

from nrs_design.certificates.certificate import dump
from nrs_design.exporters.matlab import render
from tests.support import ROOT, program_named


@pytest.fixture(params=["continuous_export", "sampled_export"])
def export(request):
    return request.getfixturevalue(request.param)


def loaded_mat(content, folder):
    file = folder / "design.mat"
    file.write_bytes(content)
    return scipy.io.loadmat(file, simplify_cells=True)


@pytest.fixture
def read(export, tmp_path):
    return loaded_mat(render(export)[".mat"], tmp_path)


def test_modes_are_the_doubles_next_to_the_exact_ones(export, read):
    system = export.certificate.system
    assert [mode["name"] for mode in np.atleast_1d(read["modes"])] == [m.name for m in system.modes]
    for mode, exact in zip(np.atleast_1d(read["modes"]), system.modes, strict=True):
        rows = exact.A.fractions()
        assert np.array_equal(mode["A"], [[float(entry) for entry in row] for row in rows])
    assert list(read["states"]) == list(system.states)


def test_gains_are_the_single_precision_numbers_that_ship(export, read):
    shipped = {("motion", gain.name): gain for gain in export.record.motion.gains}
    for controller in export.record.controllers:
        shipped |= {(controller.name, gain.name): gain for gain in controller.gains}
    found = {(gain["controller"], gain["name"]): gain for gain in read["gains"]}
    assert found.keys() == shipped.keys()
    for key, gain in shipped.items():
        assert Fraction(found[key]["value"]) == Fraction(gain.exact)
        assert found[key]["unit"] == gain.unit


def test_the_rate_is_on_its_safe_side(export, read):
    exact = Fraction(export.record.proof.decay_rate.exact)
    rate = Fraction(read["info"]["rate"])
    assert rate <= exact if read["info"]["time"] == "continuous" else rate >= exact
    assert float(rate) == pytest.approx(float(exact), rel=1e-15)


def test_the_certificate_is_there_as_it_is(export, read):
    assert read["certificate_json"] == dump(export.certificate)
    statement = export.certificate.statements[0]
    numbers = np.atleast_1d(read["statements"])[0]["numbers"]
    assert numbers.keys() == statement.to_fields().keys()


def test_no_date_is_written(export):
    text = render(export)[".mat"][:116].decode()
    assert text.strip() == f"MATLAB 5.0 MAT-file, nrs-design export of {export.record.spec.name}"


def octave_lines():
    """The program of the page, as it is printed there."""
    page = (ROOT / "docs/exports.md").read_text()
    return re.findall("```octave\n(.*?)```", page, re.DOTALL)[0]


def run_octave(export, folder, lines):
    (folder / "soft-tissue.mat").write_bytes(render(export)[".mat"])
    (folder / "check.m").write_text(lines)
    command = [program_named("octave-cli"), "--no-init-file", "check.m"]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=True, timeout=60
    )
    return done.stdout.splitlines()


def test_octave_checks_the_inequality(export, tmp_path):
    modes = [f"{mode.name} 1" for mode in export.certificate.system.modes]
    assert run_octave(export, tmp_path, octave_lines()) == ["verdict: PROVED", *modes]


def test_octave_sees_a_wrong_matrix(export, tmp_path):
    spoiled = octave_lines().replace("A = d.modes(i).A;", "A = 2*eye(rows(Q)) - d.modes(i).A;")
    modes = [f"{mode.name} 0" for mode in export.certificate.system.modes]
    assert run_octave(export, tmp_path, spoiled)[1:] == modes
