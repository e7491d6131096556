"""MAT-files, read back by SciPy and by GNU Octave."""

import re
import subprocess
from fractions import Fraction

import control
import numpy as np
import pytest
import scipy.io
import scipy.linalg

from nrs_design.certificates.certificate import dump
from nrs_design.exporters.formats.mat import render
from tests.support import ROOT, program_named, skip_for_want_of


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


def octave_lines(which=0):
    page = (ROOT / "docs/exports.md").read_text()
    return re.findall("```octave\n(.*?)```", page, re.DOTALL)[which].replace("-sampled.mat", ".mat")


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


def open_loops_in(export, folder):
    """Read the file back: loops, and where their closed ones are after a second of a unit step."""
    loops = np.atleast_1d(loaded_mat(render(export)[".mat"], folder)["open_loops"])
    return [(loop, step_of(loop)) for loop in loops]


def step_of(loop):
    """By the exponential of the closed loop, or by steps: nothing of the control package."""
    A, B, C = (np.atleast_2d(loop[name]) for name in "ABC")
    B, C = B.reshape(-1, 1), C.reshape(1, -1)
    closed, period = A - B @ C, float(loop["sample_time"])
    x = np.zeros_like(B)
    if period:
        for _ in range(round(1 / period)):
            x = closed @ x + B
    else:
        n = len(A)
        whole = np.block([[closed, B], [np.zeros((1, n + 1))]])
        x = scipy.linalg.expm(whole)[:n, n:]
    return (C @ x).item()


def has_control_package():
    done = subprocess.run(
        [program_named("octave-cli"), "--no-init-file", "--eval", "pkg load control"],
        capture_output=True,
        check=False,
    )
    return done.returncode == 0


def test_octave_rebuilds_margins_and_steps(export, tmp_path):
    """The lines of the page: `margin` and `step` of octave-control find what the file says."""
    if not has_control_package():
        skip_for_want_of("octave-control")
    lines = run_octave(export, tmp_path, octave_lines(1))
    known = open_loops_in(export, tmp_path)
    assert len(lines) == len(known) >= 6
    for line, (loop, end) in zip(lines, known, strict=True):
        name, *numbers = line.split()[:6]
        said, gain, phase_said, phase, last = map(float, numbers)
        assert name == loop["controller"]
        assert line.endswith(loop["at"])
        assert said == pytest.approx(loop["gain_margin"], abs=6e-5)
        assert gain == pytest.approx(loop["gain_margin"], abs=1e-4)
        assert phase_said == pytest.approx(np.degrees(loop["phase_margin"]), abs=6e-5)
        assert phase == pytest.approx(phase_said, abs=1e-4)
        assert last == pytest.approx(end, abs=2e-5)


def test_margins_of_python_control_are_those_of_the_file(export, tmp_path):
    """Taken of A, B, C and D, and not of the polynomials that ours are taken of."""
    for loop, _ in open_loops_in(export, tmp_path):
        n, period = len(np.atleast_2d(loop["A"])), float(loop["sample_time"])
        shaped = loop["A"], np.reshape(loop["B"], (n, 1)), np.reshape(loop["C"], (1, n)), 0
        points = np.logspace(0, np.log10(1500), 300)
        response = control.FRD(control.ss(*shaped, period), points, smooth=True)
        found = control.stability_margins(response)
        assert found[0] == pytest.approx(loop["gain_margin"], rel=1e-3)
        assert found[1] == pytest.approx(np.degrees(loop["phase_margin"]), rel=1e-3)
