import json
from pathlib import Path

import pytest

from nrs_design.errors import CertificateError
from nrs_design.gating.lock import MAX_BYTES, MAX_SPECS, Lock, dump_lock, read_lock
from nrs_design.gating.rules import RETIRED
from tests.tables import table


def test_lock_reads_back(project):
    lock = read_lock(project / "nrs.lock")
    assert Lock.model_validate(json.loads(dump_lock(lock))) == lock


TABLE = table(Path(__file__).with_suffix(".yaml"))
ENTRY = TABLE["entry"]
(GOAL,) = ENTRY["goals"]


def document(*entries, **changes):
    base = {"schema": "nrs-design/lock/2", "specs": list(entries)}
    return json.dumps({**base, **changes})


OLDER = document(schema="nrs-design/lock/1").encode()
MANY = document(*[{}] * (MAX_SPECS + 1)).encode()


@pytest.mark.parametrize("status", ["met", "missed"])
def test_goals_of_retired_rules_are_skipped(tmp_path, status):
    """An older release locked them; a gate of today renews the entry without them."""
    retired = min(RETIRED)
    old = {"rule": retired, "subject": "bounds", "status": status, "message": "as it was"}
    (tmp_path / "nrs.lock").write_text(document({**ENTRY, "goals": [old, GOAL, old]}))
    lock = read_lock(tmp_path / "nrs.lock")
    assert [goal.rule for goal in lock.specs[0].goals] == ["NRS103"]
    assert retired not in dump_lock(lock)


def spoiled(case):
    if "text" in case:
        return case["text"]
    more = [{**ENTRY, **case["more"]}] if "more" in case else []
    return document({**ENTRY, **case.get("entry", {})}, *more, **case.get("document", {}))


@pytest.mark.parametrize(
    "text",
    [
        *map(spoiled, TABLE["refused"]),
        "[" * 100_000,
        document({**ENTRY, "path": "a" * 5000}),
        document(ENTRY).replace('"rate"', '"path"'),
    ],
)
def test_what_is_not_a_lock_is_refused(tmp_path, text):
    (tmp_path / "nrs.lock").write_text(text)
    with pytest.raises(CertificateError, match="not a lock file") as caught:
        read_lock(tmp_path / "nrs.lock")
    assert caught.value.path == tmp_path / "nrs.lock"
    assert "\n" not in caught.value.message


@pytest.mark.parametrize(
    ("content", "said"),
    [
        pytest.param(b"\xff\xfe", "not a lock file", id="no text"),
        pytest.param(OLDER, "schema: Input should be 'nrs-design/lock/2'", id="another version"),
        pytest.param(MANY, "specs: List should have at most 10000 items", id="too many specs"),
        pytest.param(b" " * (MAX_BYTES + 1), "larger than 32 MiB", id="too large"),
    ],
)
def test_what_no_lock_holds_is_refused_before_it_is_looked_at(tmp_path, content, said):
    (tmp_path / "nrs.lock").write_bytes(content)
    with pytest.raises(CertificateError, match=said):
        read_lock(tmp_path / "nrs.lock")


@pytest.mark.parametrize("name", ["missing", "."])
def test_a_lock_that_cannot_be_read(tmp_path, name):
    with pytest.raises(CertificateError):
        read_lock(tmp_path / name)
