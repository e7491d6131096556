"""What is said to a command that does not exist."""

import pytest

from tests.support import run


@pytest.mark.parametrize(
    ("word", "remedy"),
    [
        ("certify", "did you mean certify-switching?"),
        ("Gat", "did you mean gate?"),
        ("exprot", "did you mean export?"),
        ("zzz", "there are init, check, schema"),
        ("x", "there are init, check, schema"),
    ],
)
def test_the_beginning_of_a_name_or_one_that_looks_alike(tmp_path, word, remedy):
    done = run(word, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"there is no command '{word}'" in done.stderr
    assert remedy in done.stderr


def test_the_words_of_wrong_usage_are_printable(tmp_path):
    assert "\u202e" not in run("check", "--no-such\u202eoption", cwd=tmp_path, code=2).stderr
