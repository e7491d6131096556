"""Every field of every side file, forged: rejected, or in a list of what no verdict shows."""

import json

import pytest

from nrs_design.certificates.certificate import content_id as certificate_id
from nrs_design.errors import NrsDesignError
from nrs_design.gating.lock import read_lock
from nrs_design.gating.locked import run_locked
from tests.certificates.test_verify import at, changed, leaves
from tests.support import ROOT, run

# Without a spec, also what only a spec tells, and how states are called; none of it is printed.
UNTOLD_WITHOUT_SPEC = {"spec", "coordinates", "gains", "assumptions", "package", "origin"} | {
    "states",
    "contact",
}
MARK = "forged"


def spoiled(value):
    """Return other values of the same kind: what a forger would write."""
    match value:
        case bool():
            return [not value]
        case int():
            return [value + 1, -value - 1]
        case str():
            doubled = [str(2 * float(value)), str(float(value) / 2)] if _is_number(value) else []
            return [*doubled, f"{value}{MARK}", ""]
        case None:
            return [MARK]
        case _:
            return []


def _is_number(text):
    try:
        return float(text) != 0
    except ValueError:
        return False


@pytest.mark.slow
def test_every_field_of_a_certificate_without_its_spec_is_rejected_or_not_printed(tmp_path):
    source = ROOT / "reports/soft-tissue.cert.json"
    document = json.loads(source.read_text())
    run("verify", source, cwd=tmp_path, code=0)
    told = set()
    for path in leaves(document):
        if path[0] in ("modes", "statements", "id") or not isinstance(at(document, path), str):
            continue
        forged = changed(document, path, f"7{MARK}")
        (tmp_path / "c.json").write_text(json.dumps(forged | {"id": certificate_id(forged)}))
        text = run("verify", "c.json", cwd=tmp_path)
        if text.returncode == 1:
            assert text.stdout.startswith("REJECTED")
            continue
        told.add(path[0])
        said = text.stdout + run("verify", "--json", "c.json", cwd=tmp_path).stdout
        assert MARK not in said, path
    assert told <= UNTOLD_WITHOUT_SPEC
    assert {"gains", "assumptions", "spec"} <= told


def test_every_field_of_a_lock(project):
    """What --locked does not decide again ends with words that say so."""
    lock = project / "nrs.lock"
    document = json.loads(lock.read_text())
    specs = sorted((project / "specs").iterdir())
    for path in leaves(document):
        for value in spoiled(at(document, path)):
            lock.write_text(json.dumps(changed(document, path, value)))
            try:
                outcome = run_locked(specs, read_lock(lock), lock)
            except NrsDesignError:
                continue
            if outcome.severity:
                continue
            # Proofs of given matrices are checked again, whichever version has locked them.
            if path[2:] == ("version",) and not document["specs"][path[1]]["gains"]:
                continue
            if path[2:3] == ("remark",):
                said = [caution.message for spec in outcome.specs for caution in spec.cautions]
                assert any("(as locked; not computed again)" in message for message in said), path
                continue
            # Text of a goal that only a design decides, and of nothing else.
            assert path[:1] + path[2:3] == ("specs", "goals"), path
            assert path[-1] in ("subject", "message"), path
            forged = [
                item
                for spec in outcome.specs
                for item in spec.obligations
                if value in (item.subject, item.message.partition(" (as locked")[0])
            ]
            assert forged, path
            assert all("(as locked; not computed again)" in item.message for item in forged)
