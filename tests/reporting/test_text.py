import pytest

from nrs_design.reporting.text import drawable, wrapped_label


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
    assert wrapped_label(text, width).split("\n") == lines
