import json

import pytest
from making.notebook import made, notebook_of, page_of, read_cells, run_cells

from tests.docs.pages import DOCS
from tests.support import ROOT
from tests.tables import entry, rows

SOURCE = entry(__file__, "SOURCE")


def test_cells_share_their_names_and_show_what_they_print_and_end_with():
    words, first, second = read_cells(SOURCE)
    assert (words.is_code, words.source) == (False, "# Title\n\nWords.")
    assert (first.is_code, first.source) == (True, "import math\nx = 2")
    assert second.source.endswith("math.sqrt(x + 2)")
    cells = run_cells([words, first, second])
    assert [cell.printed for cell in cells] == ["", "", "x is 2\n2.0\n"]
    page, images = page_of(cells, "name")
    assert "```text\nx is 2\n2.0\n```" in page
    assert images == {}
    document = json.loads(notebook_of(cells))
    assert (document["nbformat"], document["nbformat_minor"]) == (4, 5)
    written = document["cells"]
    assert [cell["cell_type"] for cell in written] == ["markdown", "code", "code"]
    assert len({cell["id"] for cell in written}) == 3
    assert "".join(written[1]["source"]) == "import math\nx = 2"
    assert written[2]["outputs"][0]["text"] == ["x is 2\n", "2.0\n"]


DRAWING = entry(__file__, "DRAWING")


def test_a_figure_becomes_an_image():
    cells = run_cells(read_cells(DRAWING))
    page, images = page_of(cells, "name")
    assert images == {"name-1.png": b"png"}
    assert "(name-1.png)" in page
    (output,) = json.loads(notebook_of(cells))["cells"][0]["outputs"]
    assert output["data"] == {"image/png": "cG5n"}


def test_an_error_is_not_swallowed():
    with pytest.raises(ZeroDivisionError):
        run_cells(read_cells("# %%\n1 / 0\n"))


@pytest.mark.slow
def test_the_tutorial(monkeypatch):
    monkeypatch.chdir(ROOT)
    cells = made(DOCS / "tutorial_python.py")
    printed = "".join(cell.printed for cell in cells)
    places = [printed.index(text) for text in rows(__file__, "test_the_tutorial")]
    assert places == sorted(places)
    assert sum(len(cell.images) for cell in cells) == 2
