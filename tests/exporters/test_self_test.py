"""The self-test finds the first step that differs, on a computer and on an emulated processor."""

import pytest

from nrs_design.exporters.formats.vectors import make_vectors
from tests.exporters.programs import LAWS, STRICT, built, compiler, emulated, run, write_law

# What a robot does before it moves: the exit code says which case is the first to differ.
MAIN = """#include "soft-tissue_test.h"
int main(void) { return (int)nrs_soft_tissue_self_test() + 1; }
"""


def written(folder, export, wrong=None):
    """Write a law with 60 cases, and another result in some of them."""
    vectors = make_vectors(LAWS["limits"], 60)
    for row, column in wrong or []:
        vectors.rows[row, vectors.columns.index(column)] ^= 1
    (folder / "main.c").write_text(MAIN)
    return folder / "main.c", *write_law(folder, export.record, LAWS["limits"], vectors)


@pytest.mark.parametrize(
    ("wrong", "first"),
    [
        ([], -1),
        ([(0, "command")], 0),
        ([(41, "after.velocity"), (17, "valid"), (59, "command")], 17),
        ([(59, "after.reference")], 59),
    ],
)
def test_the_first_case_that_differs(tmp_path, sampled_export, wrong, first):
    *sources, _ = written(tmp_path, sampled_export, wrong)
    built(compiler(), *STRICT, "-O1", *sources, "-o", tmp_path / "program")
    assert run(tmp_path / "program").returncode == first + 1


@pytest.mark.parametrize("wrong", [[], [(17, "command"), (30, "valid")]])
def test_on_an_emulated_processor(tmp_path, sampled_export, wrong):
    main, *others, _ = written(tmp_path, sampled_export, wrong)
    assert emulated(tmp_path, main, *others) == f"{18 if wrong else 0}: "


def test_the_program_around_it(tmp_path, sampled_export):
    _, *files = written(tmp_path, sampled_export, [(17, "valid")])
    built(compiler(), *STRICT, *files, "-o", tmp_path / "program")
    done = run(tmp_path / "program")
    assert (done.returncode, done.stdout) == (1, "case 17 differs\n")
