"""A command returns an answer, and one printer shows it."""

import inspect

import pytest
import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import note, say


def found(loud=False):
    return Answer(lambda: {"a": 1}, lambda: say("text"), 3, loud=loud)


@pytest.mark.parametrize(
    ("options", "loud", "out"),
    [
        ({}, False, "text\n"),
        ({"quiet": True}, False, ""),
        ({"quiet": True}, True, "text\n"),
        ({"as_json": True}, True, '{\n  "schema": "nrs-design/find/1",\n  "a": 1\n}\n'),
    ],
)
def test_one_answer_as_text_as_json_or_not_at_all(capsys, options, loud, out):
    @command("find")
    def find(name: str) -> Answer:
        """Find it."""
        note(name)
        return found(loud)

    with pytest.raises(typer.Exit) as ending:
        find(name="note", **options)
    assert ending.value.exit_code == 3
    assert capsys.readouterr() == (out, "" if "quiet" in options else "note\n")
    assert find.__doc__ == "Find it."
    assert list(inspect.signature(find).parameters) == ["name", "verbose", "quiet", "as_json"]


def test_a_command_without_a_document_has_no_json():
    @command("write", has_json=False)
    def write() -> Answer:
        return found()

    assert list(inspect.signature(write).parameters) == ["verbose", "quiet"]
