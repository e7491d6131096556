from pathlib import Path

import pytest

from nrs_design.errors import OutputError
from nrs_design.exporters import Format
from nrs_design.exporters.write import places

ONE = Format("", "", {".mat": b"MAT"})
TWO = Format("", "", {".c": b"/* ours", ".h": b"/* ours"})


def test_where_files_go(tmp_path):
    assert places(ONE, "x", Path("a/b.mat")) == {".mat": Path("a/b.mat")}
    assert places(ONE, "x", Path("a/b")) == {".mat": Path("a/b/x.mat")}
    assert places(TWO, "x", Path("a/b.2")) == {".c": Path("a/b.2/x.c"), ".h": Path("a/b.2/x.h")}
    (tmp_path / "b.mat").mkdir()
    assert places(ONE, "x", tmp_path / "b.mat") == {".mat": tmp_path / "b.mat/x.mat"}


@pytest.mark.parametrize(("format_", "name"), [(ONE, "b.txt"), (TWO, "b.c"), (TWO, "b.txt")])
def test_what_seems_to_be_another_file_makes_no_folder(tmp_path, format_, name):
    with pytest.raises(OutputError, match="seems to be a file"):
        places(format_, "x", tmp_path / name)
    (tmp_path / name).mkdir()
    assert {path.parent for path in places(format_, "x", tmp_path / name).values()} == {
        tmp_path / name
    }
