import pytest

from nrs_design.reporting.text import drawable, visible, wrapped


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("mode a/b", "mode a/b"),
        ("a\nb\r\nc", "a b c"),
        ("a\u202eb", "a\\u202eb"),
        ("\x1b[31m", "\\x1b[31m"),
        ("\udcff.csv", "\\udcff.csv"),
        ("שלום", "שלום"),
        ("中", "中"),
    ],
)
def test_visible_shows_what_has_no_shape(text, shown):
    assert visible(text) == shown


def test_drawable_has_letters_of_the_font_only():
    assert drawable("αβ שלום ≤ 中") == "αβ שלום ≤ \\u4e2d"


@pytest.mark.parametrize(
    ("text", "width", "lines"),
    [
        ("short", 20, ["short"]),
        ("insertion-slow/silicone/k-min", 20, ["insertion-slow/", "silicone/k-min"]),
        ("x" * 30, 12, ["x" * 12, "x" * 12, "x" * 6]),
        ("one two three", 8, ["one two", "three"]),
        ("", 8, [""]),
    ],
)
def test_wrapped_keeps_every_letter(text, width, lines):
    assert wrapped(text, width).split("\n") == lines
