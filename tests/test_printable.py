import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.printable import json_text, printable, visible
from tests.tables import rows

DECEPTIVE = {
    "newline": "\n",
    "carriage return": "\r",
    "escape": "\x1b",
    "C1 control sequence introducer": "\x9b",
    "delete": "\x7f",
    "line separator": "\u2028",
    "paragraph separator": "\u2029",
    "right-to-left override": "\u202e",
    "isolate": "\u2066",
    "right-to-left mark": "\u200f",
    "Arabic letter mark": "\u061c",
    "zero-width space": "\u200b",
    "byte order mark": "\ufeff",
    "Hangul filler": "\u3164",
    "variation selector": "\ufe0f",
    "tag": "\U000e0041",
    "lone surrogate": "\ud800",
    "null": "\0",
}


@pytest.mark.parametrize("character", DECEPTIVE.values(), ids=DECEPTIVE)
def test_a_deceptive_character_is_shown_as_its_escape(character):
    shown = printable(f"a{character}b")
    assert character not in shown
    assert shown.encode("utf-8").decode("unicode_escape") == f"a{character}b"


def test_a_byte_that_is_no_text_is_shown_as_a_shell_takes_it():
    name = "力.csv".encode("gbk").decode(errors="surrogateescape")
    assert printable(name) == visible(name) == r"\xc1\xa6.csv"


@pytest.mark.parametrize("text", rows(__file__, "test_honest_text_stays_as_it_is"))
def test_honest_text_stays_as_it_is(text):
    assert printable(text) == text


@pytest.mark.parametrize(
    ("text", "shown"), rows(__file__, "test_no_text_is_a_command_of_a_build_server")
)
def test_no_text_is_a_command_of_a_build_server(text, shown):
    assert printable(text) == shown


@given(st.text(st.characters()))
def test_what_is_shown_is_one_line_and_shown_again_the_same(text):
    shown = printable(text)
    assert shown.isprintable()
    assert printable(shown) == shown


@pytest.mark.parametrize(("text", "shown"), rows(__file__, "test_visible_shows_what_has_no_shape"))
def test_visible_shows_what_has_no_shape(text, shown):
    assert visible(text) == shown


def test_paths_and_errors_are_texts():
    assert printable(Path("a\nb")) == r"a\nb"
    assert printable(ValueError("a\x1bb")) == r"a\x1bb"


@given(st.dictionaries(st.text(st.characters()), st.text(st.characters())))
def test_a_json_document_is_plain_ascii_and_reads_back(document):
    text = json_text(document)
    assert text.replace("\n", "").isascii()
    assert text.replace("\n", "").isprintable()
    assert json.loads(text) == document


def test_a_json_document_holds_no_command_of_a_build_server():
    text = json_text({"name": "##[error]x\x7f"})
    assert "##[" not in text
    assert json.loads(text) == {"name": "##[error]x\x7f"}
