"""A proof in a process of its own says what it says in this one, or nothing."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from time import sleep
from typing import Any

import pytest

from nrs_design.certificates import beside
from nrs_design.certificates.beside import proof_beside
from nrs_design.certificates.certificate import content_id
from nrs_design.certificates.prove import Verification, prove
from nrs_design.certificates.verify import read_document, verify_document
from nrs_design.errors import InternalError
from nrs_design.spec import read_spec
from tests.support import ROOT

SHIPPED = {path.name.split(".")[0] for path in (ROOT / "reports").glob("*.cert.json")}
SPECS = sorted(
    path for path in (ROOT / "specs").glob("*/*.nrs.yaml") if path.name.split(".")[0] in SHIPPED
)
SPEC = ROOT / "specs" / "neuroboscope" / "soft-tissue.nrs.yaml"

if not beside.can_copy():
    pytest.skip("needs Linux and two processors", allow_module_level=True)


def _document(spec: Path) -> dict[str, Any]:
    return read_document(ROOT / "reports" / f"{spec.name.removesuffix('.nrs.yaml')}.cert.json")


@pytest.mark.parametrize(
    "spec", [SPEC, *(pytest.param(path, marks=pytest.mark.slow) for path in SPECS if path != SPEC)]
)
def test_shipped_certificates_hold_as_they_do_in_one_process(spec: Path) -> None:
    document, loaded = _document(spec), read_spec(spec)
    with proof_beside(document) as proof:
        assert proof is not None
        both = verify_document(document, loaded, proof=proof)
    alone = verify_document(document, loaded)
    assert (both.fault, both.certificate) == (None, alone.certificate)


def _worse(document: dict[str, Any]) -> None:
    (statement,) = document["statements"]
    statement["nodes"][0]["form"][0][0] = 0


def _renamed(document: dict[str, Any]) -> None:
    document["modes"][0]["name"] += "!"


def _foreign(document: dict[str, Any]) -> None:
    document["spec"]["name"] = "another"


def _malformed(document: dict[str, Any]) -> None:
    del document["statements"]


@pytest.mark.parametrize("change", [_worse, _renamed, _foreign, _malformed])
@pytest.mark.parametrize("signed", [True, False])
def test_a_changed_certificate_is_rejected_for_the_same_reason(change: Any, signed: bool) -> None:
    document, loaded = _document(SPEC), read_spec(SPEC)
    change(document)
    if signed:
        document["id"] = content_id(document)
    with proof_beside(document) as proof:
        both = verify_document(document, loaded, proof=proof)
    assert both.fault is not None
    assert both.fault == verify_document(document, loaded).fault


def test_a_process_that_ends_without_an_answer_has_proved_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    document = _document(SPEC)
    _worse(document)
    document["id"] = content_id(document)
    here = os.getpid()

    def prove_here_only(document: dict[str, Any]) -> Verification:
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGKILL)
        return prove(document)

    monkeypatch.setattr(beside, "prove", prove_here_only)
    with proof_beside(document) as proof:
        assert proof is not None
        fault = proof()
    assert fault is not None
    assert "V rises" in fault


@pytest.mark.parametrize("part", [b"nul", b'"V rises'])
def test_a_part_of_an_answer_is_none(monkeypatch: pytest.MonkeyPatch, part: bytes) -> None:
    here, write = os.getpid(), os.write

    def write_a_part(pipe: int, told: bytes) -> int:
        if os.getpid() == here:
            return write(pipe, told)
        write(pipe, part)
        os._exit(0)

    monkeypatch.setattr(os, "write", write_a_part)
    document = _document(SPEC)
    _worse(document)
    document["id"] = content_id(document)
    with proof_beside(document) as proof:
        assert proof is not None
        fault = proof()
    assert fault is not None
    assert "V rises" in fault


def test_what_fails_there_is_raised_here(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(document: object) -> None:
        raise InternalError("flint disagrees")

    monkeypatch.setattr(beside, "prove", fail)
    with proof_beside(_document(SPEC)) as proof:
        assert proof is not None
        with pytest.raises(InternalError, match="flint disagrees"):
            verify_document(_document(SPEC), read_spec(SPEC), proof=proof)


def test_a_defect_of_the_proof_is_no_fault_of_the_certificate(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(document: object) -> None:
        raise ValueError("a library stumbled")

    monkeypatch.setattr(beside, "prove", fail)
    document, loaded = _document(SPEC), read_spec(SPEC)
    with proof_beside(document) as proof, pytest.raises(ValueError, match="a library stumbled"):
        verify_document(document, loaded, proof=proof)


def test_it_ends_with_the_process_that_waits_for_it(tmp_path: Path) -> None:
    """Whoever stops the program waits for its output to be closed, by both processes."""
    program = (
        "import os, signal, time\n"
        "from nrs_design.certificates import beside\n"
        "beside.prove = lambda document: time.sleep(60)\n"
        "with beside.proof_beside({}) as proof:\n"
        "    time.sleep(0.5)\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=20)
    assert done.returncode == -signal.SIGKILL


def test_a_long_answer_arrives_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """Longer than a pipe holds, so in parts."""
    long = "no " * 100_000

    def reject(document: object) -> Verification:
        return Verification(None, long)

    monkeypatch.setattr(beside, "prove", reject)
    with proof_beside({}) as proof:
        assert proof is not None
        assert proof() == long


def _children() -> set[str]:
    """Return the processes of this one; other tests may have left servers running."""
    return set(Path(f"/proc/self/task/{os.getpid()}/children").read_text().split())


def test_nothing_is_left_open_and_no_process_is_left() -> None:
    before, others = set(os.listdir("/proc/self/fd")), _children()
    with proof_beside(_document(SPEC)):
        pass
    assert set(os.listdir("/proc/self/fd")) == before
    assert _children() == others


def test_no_process_is_killed_that_may_be_another(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where children that end are not waited for, their number is free at once."""
    killed: list[int] = []
    others = _children()
    monkeypatch.setattr(os, "kill", lambda process, _: killed.append(process))
    former = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    try:
        with proof_beside(_document(SPEC)) as proof:
            assert proof is not None
            assert proof() is None
            # The answer comes a moment before the end.
            while _children() != others:
                sleep(1e-3)
    finally:
        signal.signal(signal.SIGCHLD, former)
    assert not killed


def test_on_one_processor_nothing_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0})
    with proof_beside(_document(SPEC)) as proof:
        assert proof is None


def test_without_room_for_a_process_nothing_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> int:
        raise BlockingIOError

    monkeypatch.setattr(os, "fork", fail)
    before = set(os.listdir("/proc/self/fd"))
    with proof_beside(_document(SPEC)) as proof:
        assert proof is None
    assert set(os.listdir("/proc/self/fd")) == before
