"""A settings file of matplotlib in the working directory, as a stranger may leave one there."""

import os
import shutil
import subprocess
import sys

import pytest

from tests.support import COMMUTING, ROOT, SOFT_TISSUE, typed

HOSTILE = "figure.dpi: 7\naxes.facecolor: red\ntimezone: Nowhere\nbackend: module://evil\n"
LOOK = """\
from nrs_design.plotting import load_matplotlib
load_matplotlib()
import os, matplotlib
print(matplotlib.rcParams["timezone"], matplotlib.rcParamsOrig["figure.dpi"], os.getcwd())
"""


def look(folder, **settings):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **settings}
    return subprocess.run(
        [sys.executable, "-c", LOOK], cwd=folder, env=environment, capture_output=True, text=True
    )


def test_settings_of_the_working_directory_are_not_read(tmp_path):
    (tmp_path / "matplotlibrc").write_text(HOSTILE)
    (tmp_path / "evil.py").write_text("raise SystemExit('evil was imported')\n")
    done = look(tmp_path, MATPLOTLIBRC=str(tmp_path))
    assert done.stdout.split() == ["UTC", "100.0", str(tmp_path)], done.stderr


@pytest.mark.slow
def test_figures_are_the_same_beside_hostile_settings(tmp_path):
    pages = []
    for name in ("clean", "hostile"):
        folder = tmp_path / name
        folder.mkdir()
        if name == "hostile":
            (folder / "matplotlibrc").write_text(HOSTILE)
        shutil.copy(COMMUTING, folder / "c.nrs.yaml")
        done = typed("report", "c.nrs.yaml", "--out", "c.html", cwd=folder)
        assert done.returncode == 0, done.stderr
        pages.append((folder / "c.html").read_bytes())
    assert pages[0] == pages[1]


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with a name")
def test_a_pipe_is_not_waited_for(tmp_path):
    """Whoever opens it waits until somebody writes; python-control imports matplotlib, too."""
    os.mkfifo(tmp_path / "matplotlibrc")
    assert typed("optimize", SOFT_TISSUE, cwd=tmp_path).returncode == 0
    assert look(tmp_path).returncode == 0


def test_every_import_of_matplotlib_comes_after_its_settings():
    """Of matplotlib and of python-control, which brings it along."""
    for path in (ROOT / "nrs_design").rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        imports = text.count("\n    import control\n")
        assert imports == text.count("    load_matplotlib()\n    import control\n"), path
