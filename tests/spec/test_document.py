import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.errors import SpecError
from nrs_design.spec.document import (
    MAX_BYTES,
    MAX_DEPTH,
    MAX_NODES,
    MAX_SCALAR,
    Position,
    Scalar,
    parse_document,
    read_source,
    to_data,
)
from nrs_design.spec.edits import changed, in_one_line, node_at
from tests.support import ends_soon
from tests.tables import rows

from .samples import assert_inside, refusal


def refused(text: str) -> SpecError:
    return refusal(text, parse_document)


def test_scalars_stay_text() -> None:
    root = parse_document("a: [1.10, 010, true, 1e400, '', \"x\"]\nb: {c: 2001-01-01}\n")
    assert to_data(root) == {
        "a": ("1.10", "010", "true", "1e400", "", "x"),
        "b": {"c": "2001-01-01"},
    }


def test_every_node_has_its_place() -> None:
    root = parse_document("# title\na:\n  - x\n  - [y,  z]\n")
    assert root.keys["a"] == Position(2, 1)
    assert node_at(root, ("a", 1, 1)) == Scalar("z", Position(4, 10))


@pytest.mark.parametrize(
    ("text", "line"),
    [
        *((end.join(("a: 1", "b: 2", "a: 3", "")), 3) for end in ("\n", "\r\n", "\r")),
        ("a: 'x\u2028y\x85z'\na: 2\n", 2),
    ],
)
def test_lines_end_with_every_line_end_and_with_no_separator(text: str, line: int) -> None:
    error = refused(text)
    assert (error.line, error.column) == (line, 1)


def nested(depth: int) -> str:
    return "[" * depth + "x" + "]" * depth


def test_depth_is_limited() -> None:
    assert parse_document(nested(MAX_DEPTH))
    assert "nested deeper" in refused(nested(MAX_DEPTH + 1)).message


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "[{a: "])
def test_deep_nesting_is_refused_before_the_stack_is_used_up(opening: str) -> None:
    assert "nested deeper" in refused(opening * 100_000).message


def test_billion_laughs_are_refused_at_the_first_anchor() -> None:
    laughs = "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 20))
    with ends_soon():
        assert "anchors" in refused("a0: &a0 lol\n" + laughs).message


@given(st.text(max_size=200) | st.text("ab:-[]{}#&*!|>'\"%@`,? \n\t\r\\0123.", max_size=200))
@settings(max_examples=300)
def test_garbage_is_a_document_or_refused(text: str) -> None:
    try:
        parse_document(text)
    except SpecError as error:
        assert_inside(error, text)


def test_reads_text_with_a_mark_of_its_order(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: \xc3\xa9\r\n")
    assert to_data(parse_document(read_source(path))) == {"a": "é"}


@pytest.mark.parametrize(
    ("content", "said", "place"),
    [
        (b"", "empty", None),
        (b" \n\n", "empty", None),
        (b"a: \xff\n", "byte 0xff is not UTF-8", (1, 4)),
        ("a: 1\né: ".encode() + b"\xff\n", "byte 0xff is not UTF-8", (2, 4)),
        ("a: 1\n".encode("utf-16"), "not UTF-8", None),
        (b"#" * (MAX_BYTES + 1), "larger than", None),
        (b"<!DOCTYPE html>\n<html lang='en'>\n<p>a: b: c\n", "a page, not a spec", None),
        (b"\xef\xbb\xbf\n<HTML>" + b" " * MAX_BYTES, "a page, not a spec", None),
        (b"%PDF-1.7\n\xff", "a page, not a spec", None),
    ],
)
def test_refuses_files_that_are_no_text(tmp_path: Path, content: bytes, said: str, place) -> None:
    path = tmp_path / "a.nrs.yaml"
    path.write_bytes(content)
    with pytest.raises(SpecError, match=said) as caught:
        read_source(path)
    error = caught.value
    assert (error.path, (error.line, error.column)) == (path, place or (None, None))
    assert error.remedy


@pytest.mark.parametrize(("name", "said"), rows(__file__, "test_refuses_what_is_no_file_of_a_spec"))
def test_refuses_what_is_no_file_of_a_spec(tmp_path: Path, name: str, said: str) -> None:
    """None of it is waited for."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "run.csv").write_text("time_s,force_N\n0,1\n")
    (tmp_path / "run.tsv").write_text("time_s\tforce_N\n0\t1\n")
    with pytest.raises(SpecError, match=said):
        read_source(tmp_path / name)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a: " + "x" * (MAX_SCALAR + 1), "a text of 1001 characters"),
        ("a: '" + "x " * MAX_SCALAR + "'", "a text of 2000 characters"),
        ("? " + "x" * (MAX_SCALAR + 1) + "\n: 1", "a text of 1001 characters"),
        ("a: [" + "," * (MAX_NODES + 1), "more than 150000 keys, values or lines"),
        ("\n" * (MAX_NODES + 1) + "a: 1", "more than 150000"),
    ],
)
def test_length_and_number_are_limited(text: str, said: str) -> None:
    assert said in refused(text).message


def test_a_decimal_comma_hides_what_would_be_said_of_its_halves() -> None:
    (fault,) = refused("a: {lever_arm: 0,24 m}\nb:\n").faults
    assert fault.remedy == "write decimals with a point: a comma ends a value"


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


def test_a_value_in_one_line_is_read_as_it_was():
    said = {"nominal": "1 m", "range": ("0.5 m", "2 m")}
    assert in_one_line(said) == "{nominal: 1 m, range: [0.5 m, 2 m]}"
    assert to_data(parse_document(in_one_line(said))) == said
