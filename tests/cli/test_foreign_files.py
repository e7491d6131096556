"""No command overwrites a file of others where one of its own would stand."""

import io

import matplotlib.pyplot as plt
import pytest

from tests.gating.conftest import STABLE
from tests.support import ends_soon, run
from tests.tables import entry, words_in

PAGE = b"<!DOCTYPE html>\n<html lang='en'>\n<title>mine</title>\n"
slow = pytest.mark.slow
COMMANDS = entry(__file__, "COMMANDS")
QUICK = ("certify-switching", "schema")
# What takes long is refused before it begins.
BEFORE = entry(__file__, "BEFORE")


def figure(suffix):
    drawn, axes = plt.subplots(figsize=(1, 1))
    axes.plot([0, 1])
    buffer = io.BytesIO()
    drawn.savefig(buffer, format=suffix)
    plt.close(drawn)
    return buffer.getvalue()


def foreign(path):
    if path.suffix in (".svg", ".png"):
        return figure(path.suffix[1:])
    known = {
        ".csv": b"time_s,angle_rad,velocity_rad_s,torque_Nm,command_rpm,mode\n0,0,0,0,0,0\n",
        ".htm": PAGE,
        ".html": PAGE,
        ".json": b'{\n  "schema": "mine/1"\n}\n',
        ".mat": b"MATLAB 5.0 MAT-file, Platform: GLNXA64",
    }
    return known.get(path.suffix, b'<?xml version="1.0" encoding="UTF-8"?>\n<testsuites name="m"/>')


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in QUICK else slow) for n in COMMANDS]
)
def test_what_is_ours_is_replaced_and_what_is_not_stays(name, tmp_path):
    (tmp_path / "small.nrs.yaml").write_text(STABLE)
    typed = words_in(COMMANDS[name])
    assert run(*typed, cwd=tmp_path).returncode in (0, 1, 3)
    files = {path for path in tmp_path.rglob("*") if path.is_file()}
    again = run(*typed, cwd=tmp_path)
    assert again.returncode in (0, 1, 3), again.stderr
    # The last of them: those before it could have been replaced by then.
    named = sorted(p for p in files if not p.name.endswith((".nrs.yaml", ".lock")))
    path = next((p for p in named if p.stem == "x"), named[-1])
    path.write_bytes(foreign(path))
    before = {path: path.read_bytes() for path in files}
    for kept in files - {path}:
        before[kept] += b" "
        kept.write_bytes(before[kept])
    done = run(*typed, cwd=tmp_path)
    assert (done.returncode, path.name in done.stderr) == (2, True), done.stderr
    assert "not overwritten" in done.stderr or "not a certificate" in done.stderr
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before


@pytest.mark.parametrize("link", [False, pytest.param(True, marks=slow)])
@pytest.mark.parametrize(
    "name", [n if n == "x.html" else pytest.param(n, marks=slow) for n in BEFORE]
)
def test_a_place_that_holds_what_is_not_ours_is_refused_before_the_work(name, link, tmp_path):
    path = tmp_path / name
    if link:
        path.symlink_to(tmp_path / "elsewhere")
    else:
        path.write_bytes(foreign(path))
    with ends_soon():
        done = run(*words_in(BEFORE[name]), cwd=tmp_path)
    assert (done.returncode, name in done.stderr) == (2, True), done.stderr
    assert ("symbolic link" if link else "not overwritten") in done.stderr
    assert [p.name for p in tmp_path.iterdir()] == [name]
