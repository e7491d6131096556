"""Deployed C, token by token and macro by macro; `test_deployed.py` has whole exports."""

import pytest

from nrs_design.exporters.deployed_c import code_differences, macro_differences

CODE = """\
#include "x.h"
static const float k[1] = {0x1.8p+2F};
float f(float x) { return x - k[0]; }
"""
HEADER = "#ifndef G\n#define G\n#define N 3U\n#endif\n"


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
    (found,) = code_differences(CODE.replace("0x1.8p+2F", "1.0F"), CODE)
    assert found == "after `1 ] = {` it has `1.0F`, and the export has `0x1.8p+2F`"


def test_a_header_may_include_what_its_export_does():
    text = HEADER.replace("#define N", '#include "x.h"\n#define N')
    assert [*macro_differences(text, "G", {"N": 3}, ("x.h",))] == []
    assert [*macro_differences(text, "G", {"N": 3})]
    twice = text.replace("#define N", '#include "x.h"\n#define N')
    assert [*macro_differences(twice, "G", {"N": 3}, ("x.h",))]
    assert [*macro_differences(HEADER, "G", {"N": 4})]
