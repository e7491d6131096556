"""The readers on mutated files: an answer or an error of ours, and no mutation that is believed."""

import json
import random
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

import pytest

from nrs_design.certificates.certificate import content_id, dump
from nrs_design.certificates.verify import read_document, verify_document
from nrs_design.errors import NrsDesignError
from nrs_design.gating.lock import read_lock
from nrs_design.identification.datasets.records import read_tissue
from nrs_design.pipeline.runs import run_certification
from nrs_design.spec import read_spec
from tests.support import COMMUTING, ROOT, SOFT_TISSUE

ROUNDS = 400
# Pieces that mean something to some reader, or look as if they did.
PIECES = (
    b"", b"\0", b"\n", b"\r", b"\t", b" ", b"-", b"1", b"0", b"/", b"e999", b"nan", b"inf", b"1/0",
    b"[", b"]", b"{", b"}", b",", b":", b"?", b"!", b"&a", b"*a", b"<<", b"|", b">", b"'", b'"',
    b"#", b"%", b"\\", b"\xff", b"\xed\xa0\x80", "\u202e".encode(), b"\\ud800", b"null", b"true",
    b"../", b"1" * 5000, b"[" * 3000, b"a," * 2000,
)  # fmt: skip

RECORD = "time_s,deflection_m,force_N\n" + "".join(
    f"{k / 100},{k * k % 97 / 1e4},{k * k % 97 / 50}\n" for k in range(80)
)


def mutated(content: bytes, chance: random.Random) -> bytes:
    for _ in range(chance.randint(1, 4)):
        a, b = sorted(chance.choices(range(len(content) + 1), k=2))
        b = min(b, a + chance.choice((0, 1, 8, 200)))
        change = chance.randrange(4)
        middle = content[a:b]
        if change == 0:
            middle = chance.choice(PIECES)
        elif change == 1:
            middle = middle * 3
        elif change == 2:
            middle = bytes(byte ^ (1 << chance.randrange(8)) for byte in middle)
        else:
            middle = middle[::-1]
        content = content[:a] + middle + content[b:]
    return content


def survives(read: Callable[[Path], object], path: Path, contents: Iterable[bytes]) -> None:
    for content in contents:
        path.write_bytes(content)
        with suppress(NrsDesignError):
            read(path)


def certificate_of(spec: Path) -> tuple[bytes, object]:
    loaded = read_spec(spec)
    return dump(run_certification(loaded).certificate).encode(), loaded


LOCK = (ROOT / "nrs.lock").read_bytes()

READERS: dict[str, tuple[Callable[[Path], object], bytes]] = {
    "given matrices": (read_spec, COMMUTING.read_bytes()),
    "interaction design": (read_spec, SOFT_TISSUE.read_bytes()),
    "certificate": (read_document, b'{"a": [1, 2, {"b": "c"}], "d": null}'),
    "lock": (read_lock, LOCK),
    "record": (read_tissue, RECORD.encode()),
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(
    "rounds", [40, pytest.param(ROUNDS, marks=pytest.mark.slow)], ids=["some", "many"]
)
def test_a_mutated_file_is_read_or_refused(tmp_path, reader, rounds):
    read, content = READERS[reader]
    chance = random.Random(reader)
    (tmp_path / "file").write_bytes(content)
    assert read(tmp_path / "file")
    survives(read, tmp_path / "file", (mutated(content, chance) for _ in range(rounds)))


@pytest.mark.parametrize(
    "rounds", [30, pytest.param(ROUNDS, marks=pytest.mark.slow)], ids=["some", "many"]
)
@pytest.mark.parametrize("signed", [False, True])
def test_a_mutated_certificate_is_not_believed(tmp_path, rounds, signed):
    content, loaded = certificate_of(COMMUTING)
    honest = json.loads(content)
    path, chance = tmp_path / "cert.json", random.Random(7)
    for _ in range(rounds):
        path.write_bytes(mutated(content, chance))
        try:
            document = read_document(path)
        except NrsDesignError:
            continue
        if signed:
            document["id"] = content_id(document)
        if verify_document(document, loaded).fault is None:
            assert is_true(document, honest)


def is_true(document: dict, honest: dict) -> bool:
    """Tell whether a certificate says the same, or the same with other evidence that holds.

    The version is a remark. Numbers of the evidence may change as long as the exact check still
    passes; what is claimed follows from them.
    """
    free = ("id", "package", "statements")
    same = all(document[key] == honest[key] for key in honest if key not in free)
    kinds = [[item["kind"] for item in d["statements"]] for d in (document, honest)]
    return same and set(kinds[0]) == set(kinds[1])
