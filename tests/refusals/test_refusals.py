"""What is refused, where, and in which words: the tables of this folder, a line for each case.

Of an edited spec, the fault that says these words (or all of a list) stands where the edit begins,
or where the piece `at` first stands from the edited line on. A group says which spec its cases
edit (`base`), by which reader of `nrs_design.spec` their texts are refused, or with which words
(`command`) their lines begin; such a line ends with 2 and writes nothing.
"""

from functools import partial
from importlib import import_module
from itertools import takewhile, zip_longest
from pathlib import Path

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import kinds
from nrs_design.spec.quantity import parse_quantity
from tests.spec.samples import assert_inside, place_of, refusal
from tests.support import run
from tests.tables import (
    cases_of,
    edit_of,
    edited,
    files_in,
    spec_text,
    words_in,
    words_of,
    write_files,
)


def cases(key):
    files = sorted(Path(__file__).parent.glob("*.yaml"))
    return [case for file in files for case in cases_of(file, key)]


def changed_line(base, text):
    """Return where the first line that is not the same begins."""
    lines = zip_longest(base.splitlines(), text.splitlines())
    same = [before for before, _ in takewhile(lambda pair: pair[0] == pair[1], lines)]
    return len("\n".join([*same, ""]))


@pytest.mark.parametrize("case", cases("base"))
def test_a_spec_is_refused(case):
    base, edit = spec_text(case["base"]), edit_of(case)
    text = edited(base, edit)
    said = [
        fault
        for fault in refusal(text).faults
        if all(words in f"{fault.message} ({fault.remedy})" for words in words_of(case))
    ]
    place = place_of(text, case.get("at", edit[1]), changed_line(base, text))
    assert said
    assert place in [(fault.line, fault.column) for fault in said]
    assert all(fault.remedy for fault in said)


@pytest.mark.parametrize("case", cases("reader"))
def test_a_text_is_refused(case):
    module, _, name = f"nrs_design.spec.{case['reader']}".rpartition(".")
    read = getattr(import_module(module), name)
    if read is parse_quantity:
        read = partial(read, kind=getattr(kinds, case["kind"]))
    with pytest.raises(SpecError) as caught:
        read(case["text"])
    error = caught.value
    said = f"{error.message} ({error.remedy})"
    assert error.remedy
    assert all(words in said for words in words_of(case))
    assert "never" not in case or case["never"] not in error.remedy
    if name in ("parse_document", "parse_spec"):
        assert_inside(error, case["text"])
    assert case.get("place") in (None, [error.line, error.column])


@pytest.mark.parametrize("case", cases("command"))
def test_a_command_is_refused(case, tmp_path):
    write_files(case.get("files", {}), tmp_path)
    before = files_in(tmp_path)
    done = run(*words_in(f"{case['command']} {case['run']}"), cwd=tmp_path, code=2)
    said = " ".join(done.stderr.replace("│", " ").split())
    for words in words_of(case):
        assert words in said
    assert bool(done.stdout) == ("--json" in case["run"])
    assert "Traceback" not in said
    assert files_in(tmp_path) == before
