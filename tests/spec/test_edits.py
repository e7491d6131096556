"""A document with one place changed."""

import pytest

from nrs_design.spec.document import parse_document, to_data
from nrs_design.spec.edits import changed, in_one_line, node_at

TEXT = "a: {b: 1 m, c: [x, y]}\nd: text\n"


@pytest.mark.parametrize(
    ("at", "said", "after"),
    [
        (("a", "b"), "2 m", {"a": {"b": "2 m", "c": ("x", "y")}, "d": "text"}),
        (("a", "c", 1), ("p", "q"), {"a": {"b": "1 m", "c": ("x", ("p", "q"))}, "d": "text"}),
        (("a", "c", 0), None, {"a": {"b": "1 m", "c": ("y",)}, "d": "text"}),
        (("a",), None, {"d": "text"}),
        (("e",), {"f": "g"}, {"a": {"b": "1 m", "c": ("x", "y")}, "d": "text", "e": {"f": "g"}}),
    ],
)
def test_one_place_is_changed_and_the_order_stays(at, said, after):
    root = parse_document(TEXT)
    data = to_data(changed(root, at, said))
    assert data == after
    # The order of keys counts: modes and controllers are numbered by it.
    assert list(data) == list(after)
    assert to_data(root) == to_data(parse_document(TEXT))


def test_everything_keeps_its_position():
    root = changed(parse_document(TEXT), ("a", "b"), "2 m")
    assert node_at(root, ("d",)) == node_at(parse_document(TEXT), ("d",))
    assert node_at(root, ("a", "b")).position == node_at(parse_document(TEXT), ("a", "b")).position


@pytest.mark.parametrize("at", [("e",), ("a", "c", 2), ("d", "b"), ("a", 0)])
def test_what_is_not_there_is_nothing(at):
    assert node_at(parse_document(TEXT), at) is None


def test_a_value_in_one_line_is_read_as_it_was():
    said = {"nominal": "1 m", "range": ("0.5 m", "2 m")}
    assert in_one_line(said) == "{nominal: 1 m, range: [0.5 m, 2 m]}"
    assert to_data(parse_document(in_one_line(said))) == said
