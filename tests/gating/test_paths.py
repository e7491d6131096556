import os
from pathlib import Path
from urllib.parse import unquote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.gating.obligations import from_here, is_utf8, relative_uri

NAMES = st.text(st.characters(exclude_characters="/\0", codec="utf-8"), min_size=1).filter(
    lambda name: name not in (".", "..")
)


@given(NAMES)
def test_uri_reads_back_as_the_name(name):
    uri = relative_uri(Path("specs", name))
    assert unquote(uri) == f"specs/{name}"
    assert set(uri).isdisjoint(' "<>?#\n')
    assert uri.isascii()


@pytest.mark.parametrize("raw", [b"a\xff.nrs.yaml"])
def test_a_name_that_is_not_utf8_can_be_told_and_shown(raw):
    path = Path(os.fsdecode(raw))
    assert not is_utf8(path)
    assert is_utf8(Path("ä.nrs.yaml"))
    assert from_here(path).encode() == b"a\\xff.nrs.yaml"
    assert relative_uri(path) == "a%FF.nrs.yaml"
