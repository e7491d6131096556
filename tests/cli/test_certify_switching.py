"""`nrs-design certify-switching`, as a user types it."""

import json
import os
import subprocess
import sys

import pytest

from nrs_design.spec import read_spec
from tests.support import COMMUTING, PRINT_ERROR, ROOT, SOFT_TISSUE, run, write_spec

INCONCLUSIVE = ([[-1, -1], [1, -1]], [[-1, -6], ["1/6", -1]])


def test_proved(tmp_path):
    result = run("certify-switching", SOFT_TISSUE, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("soft-tissue: PROVED (common quadratic function: exists)")
    assert "Every solution of x' = A x" in result.stdout
    assert "taken for granted:" in result.stdout
    assert "certificate written to reports/soft-tissue.cert.json" in result.stderr
    document = json.loads((tmp_path / "reports" / "soft-tissue.cert.json").read_text())
    assert document["verdict"] == "proved"


def test_refuted(tmp_path):
    result = run("certify-switching", PRINT_ERROR, cwd=tmp_path)
    assert result.returncode == 1
    assert "REFUTED" in result.stdout
    assert "eigenvalue 10.6523 +- 17.71j" in result.stdout


def test_inconclusive_leaves_no_file(tmp_path):
    write_spec(tmp_path / "six.nrs.yaml", *INCONCLUSIVE)
    result = run("certify-switching", "six.nrs.yaml", cwd=tmp_path)
    assert result.returncode == 3
    assert "INCONCLUSIVE" in result.stdout
    assert "not a statement of stability" in result.stdout
    assert not (tmp_path / "reports").exists()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["missing.nrs.yaml"], "no such file"),
        ([], "Missing argument"),
        ([str(COMMUTING), "--method", "guess"], "guess"),
        ([str(COMMUTING), "--coordinates", "force"], "neither gains nor coordinates"),
        ([str(COMMUTING), "--unknown"], "--unknown"),
        (["."], "directory"),
    ],
)
def test_wrong_usage(tmp_path, arguments, reason):
    result = run("certify-switching", *arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert reason in result.stderr
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert not list(tmp_path.iterdir())


def test_gradient_in_discrete_time_is_wrong_usage(tmp_path):
    write_spec(tmp_path / "d.nrs.yaml", [["1/2"]], time="discrete")
    result = run("certify-switching", "d.nrs.yaml", "--method", "gradient", cwd=tmp_path)
    assert result.returncode == 2
    assert "error[NRS002]" in result.stderr
    assert "use --method lmi" in result.stderr


def test_json(tmp_path):
    result = run("certify-switching", SOFT_TISSUE, "--json", "--out", "c.json", cwd=tmp_path)
    assert result.returncode == 0
    document = json.loads(result.stdout)
    certificate = json.loads((tmp_path / "c.json").read_text())
    assert document["schema"] == "nrs-design/certify-switching/1"
    assert document["verdict"] == "proved"
    assert document["common_quadratic"] == "exists"
    assert document["method"] == "lmi"
    assert document["decay_rate"] == pytest.approx(3.914, abs=0.01)
    assert document["decay_rate_unit"] == "1/s"
    assert document["decay_rate_exact"] == certificate["rate"]
    assert document["modes"] == certificate["modes"]
    assert document["gains"] == certificate["gains"]
    assert document["assumptions"] == certificate["assumptions"]
    assert document["claim"] == certificate["claim"]
    assert document["certificate"] == "c.json"
    assert document["certificate_id"] == certificate["id"]
    assert document["spec_sha256"] == read_spec(SOFT_TISSUE).sha256


@pytest.mark.parametrize(
    ("spec", "code", "verdict"), [(PRINT_ERROR, 1, "refuted"), (None, 3, "inconclusive")]
)
def test_json_without_a_proof(tmp_path, spec, code, verdict):
    path = spec or write_spec(tmp_path / "six.nrs.yaml", *INCONCLUSIVE).path
    result = run("certify-switching", path, "--json", cwd=tmp_path)
    assert result.returncode == code
    document = json.loads(result.stdout)
    assert document["verdict"] == verdict
    assert document["decay_rate"] is None
    assert (document["certificate"] is None) == (verdict == "inconclusive")
    assert (document["claim"] is None) == (verdict == "inconclusive")


def test_quiet(tmp_path):
    result = run("certify-switching", COMMUTING, "-q", cwd=tmp_path)
    assert result.returncode == 0
    assert result.stdout == "commuting: PROVED (common quadratic function: exists)\n"


def test_verbose_lists_every_step(tmp_path):
    result = run("certify-switching", COMMUTING, "-v", cwd=tmp_path)
    assert "suspicious modes: none" in result.stdout
    assert "lmi: found" in result.stdout


@pytest.mark.parametrize(
    "environment", [{}, {"NO_COLOR": "1"}, {"FORCE_COLOR": "1", "NO_COLOR": "1"}]
)
def test_no_color_in_a_pipe(tmp_path, environment):
    result = run("certify-switching", COMMUTING, "-v", cwd=tmp_path, environment=environment)
    assert "\x1b" not in result.stdout + result.stderr


def test_unwritable_output(tmp_path):
    (tmp_path / "file").write_text("precious")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    for out in ("file/c.json", "link", "."):
        result = run("certify-switching", COMMUTING, "--out", out, cwd=tmp_path)
        assert result.returncode == 2, out
        assert "error[NRS005]" in result.stderr
        assert result.stdout == ""
    assert (tmp_path / "file").read_text() == "precious"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "link"]


def test_coordinates(tmp_path):
    result = run("certify-switching", SOFT_TISSUE, "--coordinates", "force", "--json", cwd=tmp_path)
    document = json.loads(result.stdout)
    assert document["coordinates"] == "force"
    assert document["states"][-1] == "F [N*m]"
    assert any("not physical" in assumption for assumption in document["assumptions"])


def start(arguments, **streams):
    command = [sys.executable, "-m", "nrs_design", *map(str, arguments)]
    return subprocess.Popen(command, text=True, **streams)


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_reader_that_has_gone(tmp_path, unbuffered):
    """It is an I/O error; exit code 1 would say "refuted" of a system that is proved."""
    read, write = os.pipe()
    os.close(read)
    env = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    process = start(
        ["certify-switching", COMMUTING],
        stdout=write,
        stderr=subprocess.PIPE,
        cwd=tmp_path,
        env=env,
    )
    os.close(write)
    _, errors = process.communicate()
    assert process.returncode == 2
    assert "Traceback" not in errors
    assert "internal error" not in errors


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_full_disk(tmp_path, unbuffered):
    env = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    with open("/dev/full", "w") as full:
        process = start(
            ["certify-switching", COMMUTING],
            stdout=full,
            stderr=subprocess.PIPE,
            cwd=tmp_path,
            env=env,
        )
        _, errors = process.communicate()
    assert process.returncode == 2
    assert "the output cannot be written" in errors


@pytest.mark.parametrize(
    ("command", "closed"),
    [
        ("certify-switching", ">&-"),
        ("certify-switching", "2>&-"),
        ("certify-switching", ">&- 2>&-"),
        ("tune", ">&-"),
    ],
)
def test_closed_streams(tmp_path, command, closed):
    line = f'exec "$0" -m nrs_design {command} "$1" {closed}'
    result = subprocess.run(
        ["sh", "-c", line, sys.executable, str(SOFT_TISSUE)],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=False,
    )
    assert result.returncode == 0
    assert "internal error" not in result.stderr
