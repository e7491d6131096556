"""Answers in files: whole or not at all, and never another one's."""

import json

import pytest

from nrs_design.sweeps.store import CachedAnswer, Store, key_of

KEY = key_of("meaning", ("check",), "1")
KEPT = CachedAnswer(1, {"verdict": "refuted", "rate": 0.1, "modes": ["a", "b"], "none": None})


@pytest.fixture
def store(tmp_path):
    store = Store(tmp_path / "new")
    store.write(KEY, KEPT)
    return store


def test_what_is_written_is_read(store):
    assert store.read(KEY) == KEPT
    assert store.read(key_of("meaning", ("check",), "2")) is None


@pytest.mark.parametrize(
    "other", [("x", ("check",), "1"), ("meaning", ("tune",), "1"), ("meaning", ("check",), "2")]
)
def test_the_name_tells_meaning_command_and_version(other):
    assert key_of(*other) != KEY


def test_nothing_is_left_beside_it(store):
    assert [p.name for p in store.folder.rglob("*") if p.is_file()] == [f"{KEY}.json"]


def test_every_cut_and_every_change_is_noticed(store):
    entry = store.entry(KEY)
    whole = entry.read_bytes()
    for end in range(len(whole) - 1):
        entry.write_bytes(whole[:end])
        assert store.read(KEY) is None
    for at in range(len(whole)):
        entry.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :])
        # A changed space is no change.
        assert store.read(KEY) in (None, KEPT)
    entry.write_bytes(whole)
    assert store.read(KEY) == KEPT


def test_an_answer_in_the_place_of_another_is_none(store):
    other = key_of("other", ("check",), "1")
    store.entry(other).parent.mkdir(parents=True, exist_ok=True)
    store.entry(KEY).rename(store.entry(other))
    assert store.read(other) is None


def test_no_file_of_an_answer_is_waited_for_or_followed(store):
    document = json.loads(store.entry(KEY).read_text(encoding="utf-8"))
    assert document["key"] == KEY
    store.entry(KEY).unlink()
    store.entry(KEY).mkdir()
    assert store.read(KEY) is None


def test_a_dropped_certificate_leaves_the_answer(store):
    store.certificate(KEY).touch()
    store.drop_certificate(KEY)
    store.drop_certificate(KEY)
    assert [path for path in store.folder.rglob("*") if path.is_file()] == [store.entry(KEY)]
