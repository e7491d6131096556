"""A settings file of matplotlib in the working directory, as a stranger may leave one there."""

import os

import pytest

from tests.package import FILES
from tests.support import ROOT, started
from tests.test_structure import imports

HOSTILE = "figure.dpi: 7\naxes.facecolor: red\ntimezone: Nowhere\nbackend: module://evil\n"
LOOK = """\
import os, nrs_design.plotting, matplotlib
print(matplotlib.rcParams["timezone"], matplotlib.rcParamsOrig["figure.dpi"], os.getcwd())
"""


def look(folder, **settings):
    return started("-c", LOOK, cwd=folder, **settings)


def test_settings_of_the_working_directory_are_not_read(tmp_path):
    (tmp_path / "matplotlibrc").write_text(HOSTILE)
    (tmp_path / "evil.py").write_text("raise SystemExit('evil was imported')\n")
    done = look(tmp_path, MATPLOTLIBRC=str(tmp_path))
    assert done.stdout.split() == ["UTC", "100.0", str(tmp_path)], done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["pipe", "device", "bad"])
def test_whoever_draws_first_reads_no_settings(tmp_path, kind):
    """A page with all its sections: what they import is imported with them."""
    settings = tmp_path / "matplotlibrc"
    if kind == "pipe":
        os.mkfifo(settings)
    elif kind == "device":
        settings.symlink_to("/dev/zero")
    else:
        settings.write_bytes(HOSTILE.encode() + b"\xff\n")
    # Every module of the house, in an order that is none.
    names = sorted(FILES, key=lambda name: name[::-1])
    load = (
        "import importlib, sys\n"
        "from nrs_design.reporting.style import new_axes\n"
        f"for name in {names!r}:\n"
        "    if not name.endswith('__main__'): importlib.import_module(name)\n"
        "new_axes()\n"
    )
    done = started("-c", load, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


DOORS = {"nrs_design.plotting", "nrs_design.control_library"}
BEHIND = {"matplotlib", "mpl_toolkits", "pylab", "control"}


def test_matplotlib_has_one_door():
    """Of the package; so has python-control, which brings matplotlib along."""
    past = {
        (item.source, item.target)
        for item in imports()
        if item.target.split(".")[0] in BEHIND and not item.typing_only
    }
    assert {source for source, _ in past} == DOORS
    text = (ROOT / "nrs_design/control_library.py").read_text(encoding="utf-8")
    assert text.index("import plotting") < text.index("import control")
