"""Deployed texts: C token by token, others line by line; `test_deployed.py` has whole exports."""

import pytest

from nrs_design.exporters.deployed_c import code_differences, line_differences

CODE = """\
#include "x.h"
static const float k[1] = {0x1.8p+2F};
float f(float x) { return x - k[0]; }
bool g(bool a, const bool *b) { return a && b[0]; }
"""


@pytest.mark.parametrize(
    "text",
    [
        CODE,
        CODE.replace("\n", "\r\n"),
        CODE.replace(" - ", "/* less */-// k\n"),
        "/* of it */" + CODE.replace("{", "\n{\n"),
    ],
)
def test_space_and_comments_are_no_difference(text):
    assert [*code_differences(text, CODE)] == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (" - ", " + "),
        ("0x1.8p+2F", "0x1.8p+3F"),
        ("0x1.8p+2F", "0x1.8p+2"),
        ("k[0]", "kk[0]"),
        ("&&", "& &"),
        ("#include", "#define y 1\n#include"),
        # What follows a directive in its line is part of it.
        ('"x.h"\n', '"x.h" '),
        ('"x.h"\n', '"x.h" /* \n */ '),
        ("x - ", "x - /"),
        ("return", "return \\\n"),
        ("}\n", ""),
        ("x.h", "/*x.h"),
    ],
)
def test_every_token_counts(old, new):
    assert old in CODE
    (found,) = code_differences(CODE.replace(old, new, 1), CODE)
    assert found


def test_where_it_differs_is_said():
    """By the line of the file that was deployed, its comments counted."""
    text = "/* two\nlines */\n" + CODE.replace("0x1.8p+2F", "1.0F")
    (found,) = code_differences(text, CODE)
    assert found == "line 4, after `1 ] = {`: it has `1.0F`, and the export has `0x1.8p+2F`"
    (found,) = code_differences(CODE + "int y;", CODE)
    assert found.endswith("it has `int`, and the export has nothing")
    (found,) = code_differences(CODE.removesuffix("}\n"), CODE)
    assert found.startswith("at its end, after `[ 0 ] ;`: it has nothing")


def test_every_line_counts_but_the_release():
    """Comments, too: one that names a coding, or a bracket in CMake, hides what follows."""
    wanted = "# nrs-design 0.1.0, nrs-design/export/1\n# one\na,b\n1,2\n"
    for same in (wanted, wanted.replace("0.1.0", "2.0.0rc1"), wanted.replace("\n", "\r\n")):
        assert [*line_differences(same, wanted)] == []
    (found,) = line_differences(wanted.replace("1,2", "1,3"), wanted)
    assert found == "line 4: it has `1,3`, and the export has `1,2`"
    (found,) = line_differences(wanted.removesuffix("1,2\n"), wanted)
    assert found == "line 4: it has nothing, and the export has `1,2`"
    for other in (
        wanted + "3,4",
        wanted.replace("a,b", "  a,b"),
        wanted.replace("# one", "# one\rx"),
        wanted.replace("# one", "#[[\n# one"),
        f"# coding: raw_unicode_escape\n{wanted}",
        "",
    ):
        assert len([*line_differences(other, wanted)]) == 1


@pytest.mark.parametrize("text", ["#define X (a)\nint y;\n", "#define X(a)\nint y;\n"])
def test_a_space_before_parameters_of_a_macro_counts(text):
    other = text.replace("X (", "X(") if "X (" in text else text.replace("X(", "X (")
    assert [*code_differences(text, text)] == []
    assert len([*code_differences(text, other)]) == 1
