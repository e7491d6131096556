"""A gate keeps what is recorded and still holds; it searches for what is not, or may be more."""

import pytest

from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.lock import read_lock_if_any
from nrs_design.gating.renew import recorded_in, write_lock
from nrs_design.gating.run import Files, run_gate
from nrs_design.pipeline.certification import Overrides

from .conftest import HARD, UNSTABLE, restated


@pytest.fixture
def gate(project, monkeypatch):
    """Run the gate on a spec and renew the lock; return whether there was a search."""
    from nrs_design.gating import run

    certify, searched = run.run_certification, []

    def count(loaded, **options):
        searched.append(loaded.spec.name)
        return certify(loaded, **options)

    monkeypatch.setattr(run, "run_certification", count)

    def examine(name="stable", folder="reports", **overrides):
        searched.clear()
        lock = project / "nrs.lock"
        known = read_lock_if_any(lock)
        files = Files(folder=project / folder, html=False, locked=recorded_in(known, lock))
        specs = find_specs([project / f"specs/{name}.nrs.yaml"])
        outcome = run_gate(specs, files, overrides=Overrides(**overrides))
        write_lock(outcome, lock)
        return bool(searched)

    return examine


def contents(project):
    files = sorted(path for path in project.rglob("*") if path.is_file())
    return {file.relative_to(project): file.read_bytes() for file in files}


@pytest.mark.parametrize("name", ["stable", "soft-tissue", "unstable"])
def test_what_still_holds_is_not_searched_for_and_nothing_changes(project, gate, name):
    """Nor what is refuted, once it has been."""
    if name == "unstable":
        (project / "specs/unstable.nrs.yaml").write_text(UNSTABLE)
        assert gate("unstable")
    before = contents(project)
    assert not gate(name)
    assert contents(project) == before


def test_a_certificate_counts_without_a_lock_and_in_another_folder(project, gate):
    text = (project / "reports/stable.cert.json").read_text()
    lock = (project / "nrs.lock").read_bytes()
    assert not gate(folder="ci")
    assert (project / "ci/stable.cert.json").read_text() == text
    (project / "nrs.lock").unlink()
    assert not gate()
    assert not gate("soft-tissue")
    assert (project / "nrs.lock").read_bytes() == lock


@pytest.mark.parametrize("overrides", [{"budget": 9.0}, {"max_degree": 4}, {"memory": 1.0}])
def test_who_sets_how_far_a_search_goes_wants_one(gate, overrides):
    assert gate(**overrides)


def _altered(document):
    (statement, *_) = document["statements"]
    statement["rate"] = "1000"


@pytest.mark.parametrize(
    ("change", "locked"),
    [
        pytest.param(lambda d: d.update(schema="nrs-design/certificate/7"), False, id="schema"),
        pytest.param(_altered, False, id="does not hold"),
        pytest.param(lambda d: d["spec"].update(sha256="0" * 64), False, id="another spec"),
        # It holds, and is another than the one that was locked.
        pytest.param(lambda d: d["package"].update(version="0.1"), True, id="not the locked one"),
    ],
)
def test_what_does_not_hold_or_is_not_the_locked_one_is_searched_for(project, gate, change, locked):
    text = (project / "reports/stable.cert.json").read_text()
    if not locked:
        (project / "nrs.lock").unlink()
    restated(project / "reports/stable.cert.json", change)
    assert gate()
    assert (project / "reports/stable.cert.json").read_text() == text


def test_a_goal_that_the_certificate_does_not_show_is_searched_for(project, gate):
    spec = project / "specs/soft-tissue.nrs.yaml"
    spec.write_text(f"{spec.read_text()}goals: {{decay_rate: 900 1/s}}\n")
    assert gate("soft-tissue")
    assert gate("soft-tissue")


def test_what_is_open_is_searched_for_again(project, gate, monkeypatch):
    monkeypatch.setattr("nrs_design.gating.run.find_blocked", lambda *given: None)
    (project / "specs/hard.nrs.yaml").write_text(HARD.replace("max_degree: 8", "max_degree: 2"))
    assert gate("hard")
    assert (project / "reports/hard.cert.json").exists()
    assert gate("hard")
