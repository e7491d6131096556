import json
import os
import subprocess
import sys

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.lock import read_lock
from nrs_design.gating.locked import run_locked
from nrs_design.gating.obligations import Status
from nrs_design.gating.renew import write_lock
from nrs_design.gating.run import Files, run_gate
from nrs_design.spec.templates import TEMPLATES

from .conftest import GROWING, HARD, SOFT_TISSUE, STABLE, UNSTABLE


@pytest.fixture
def check(project):
    def run(*names):
        specs = find_specs([project / name for name in names or ("specs",)])
        lock = project / "nrs.lock"
        named = [project / name for name in names or ("specs",)]
        return run_locked(specs, read_lock(lock), lock, named=named)

    return run


def broken(outcome):
    return [(item.rule.id, str(item.status)) for item in outcome.broken]


def edit_lock(project, edit):
    document = json.loads((project / "nrs.lock").read_text())
    edit(document["specs"])
    (project / "nrs.lock").write_text(json.dumps(document))


def edit_certificate(project, edit):
    """Change the certificate of the pair of modes, and sign it again."""
    file = project / "reports/stable.cert.json"
    document = json.loads(file.read_text())
    edit(document)
    document["id"] = content_id(document)
    file.write_text(json.dumps(document))
    return document["id"]


def test_unchanged_project_passes(check):
    outcome = check()
    assert outcome.severity == 0
    assert [spec.verdict for spec in outcome.specs] == ["proved", "proved"]
    assert {item.rule.id for spec in outcome.specs for item in spec.obligations} == {
        "NRS101",
        "NRS102",
        "NRS103",
        "NRS104",
        "NRS105",
    }


def test_comments_line_ends_and_quotes_change_nothing(check, project):
    file = project / "specs/stable.nrs.yaml"
    text = "# only a comment\n" + STABLE.replace("[-1, 1]", '["-1",   1]')
    file.write_bytes(text.replace("\n", "\r\n").encode())
    assert check().severity == 0


def test_changed_spec(check, project):
    (project / "specs/stable.nrs.yaml").write_text(STABLE.replace("[-2, 3]", "[-2, 3.0]"))
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "has changed since it was locked" in outcome.broken[0].message


def test_new_spec(check, project):
    (project / "specs/new.nrs.yaml").write_text(UNSTABLE)
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "is not in nrs.lock" in outcome.broken[0].message


def test_spec_that_is_gone(check, project):
    (project / "specs/stable.nrs.yaml").unlink()
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "no longer exists" in outcome.broken[0].message
    assert outcome.broken[0].path.as_posix() == "specs/stable.nrs.yaml"


def test_renamed_spec_fails_twice(check, project):
    (project / "specs/stable.nrs.yaml").rename(project / "specs/other.nrs.yaml")
    assert broken(check()) == [("NRS105", "missed")] * 2


def test_a_spec_that_moved_behind_a_link_to_a_folder(check, project, tmp_path):
    (project / "specs/part").mkdir()
    (project / "specs/stable.nrs.yaml").rename(project / "specs/part/stable.nrs.yaml")
    edit_lock(project, lambda specs: specs[1].update(path="specs/part/stable.nrs.yaml"))
    assert check().severity == 0
    (project / "specs/part").rename(tmp_path / "elsewhere")
    (project / "specs/part").symlink_to(tmp_path / "elsewhere")
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "was not examined" in outcome.broken[0].message
    assert outcome.broken[0].path.as_posix() == "specs/part/stable.nrs.yaml"


def test_a_spec_that_moved_into_a_hidden_folder(check, project):
    (project / "specs/.part").mkdir()
    (project / "specs/stable.nrs.yaml").rename(project / "specs/.part/stable.nrs.yaml")
    edit_lock(project, lambda specs: specs[1].update(path="specs/.part/stable.nrs.yaml"))
    assert broken(check()) == [("NRS105", "missed")]
    assert check("specs/.part", "specs").severity == 0


def test_locked_spec_that_was_not_named_is_noted(check):
    outcome = check("specs/stable.nrs.yaml")
    assert outcome.severity == 0
    assert "specs/soft-tissue.nrs.yaml" in outcome.notes[0]


def test_missing_certificate(check, project):
    (project / "reports/stable.cert.json").unlink()
    assert broken(check()) == [("NRS004", "error")]


def test_certificate_that_is_no_json(check, project):
    (project / "reports/stable.cert.json").write_text("{")
    assert broken(check()) == [("NRS004", "error")]


def test_edited_certificate(check, project):
    file = project / "reports/stable.cert.json"
    file.write_text(file.read_text().replace("Every solution", "No solution"))
    assert broken(check()) == [("NRS104", "missed")]


def test_certificate_of_another_spec(check, project):
    (project / "reports/stable.cert.json").write_bytes(
        (project / "reports/soft-tissue.cert.json").read_bytes()
    )
    assert broken(check()) == [("NRS104", "missed")]


def test_valid_certificate_other_than_the_locked_one(check, project):
    def scale(document):
        document["statements"][0]["Q"]["denominator_log2"] += 1

    new = edit_certificate(project, scale)
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "not the certificate that was locked" in outcome.broken[0].message
    # Locked by its id, it holds: a scaled function proves the same.
    edit_lock(project, lambda specs: specs[1]["certificate"].update(id=new))
    assert check().severity == 0


def test_false_certificate_with_a_lock_to_match(check, project):
    def flip(document):
        numerators = document["statements"][0]["Q"]["numerators"]
        numerators[0][0] = -numerators[0][0]

    new = edit_certificate(project, flip)
    edit_lock(project, lambda specs: specs[1]["certificate"].update(id=new))
    assert broken(check()) == [("NRS104", "missed")]


@pytest.mark.parametrize(
    "change", [{"rate": "99"}, {"rate": None}, {"verdict": "refuted"}], ids=str
)
def test_lock_that_says_more_than_its_certificate(check, project, change):
    edit_lock(project, lambda specs: specs[1].update(change))
    assert broken(check()) == [("NRS105", "missed")]


def test_forged_hash(check, project):
    edit_lock(project, lambda specs: specs[1].update(sha256="0" * 64))
    assert broken(check()) == [("NRS105", "missed")]


def test_a_locked_spec_that_is_now_a_robot(check, project):
    """What makes no claim passes, but not in place of a claim that was locked."""
    (project / "specs/stable.nrs.yaml").write_text(TEMPLATES["robot"])
    outcome = check()
    assert "changed since it was locked" in outcome.specs[-1].obligations[0].message
    assert outcome.severity == 2


def test_dropped_entry(check, project):
    edit_lock(project, lambda specs: specs.pop())
    assert broken(check()) == [("NRS105", "missed")]


@pytest.mark.parametrize("file", ["nowhere", "reports", "x" * 4000])
def test_hostile_certificate_paths(check, project, file):
    edit_lock(project, lambda specs: specs[1]["certificate"].update(file=file))
    assert broken(check()) == [("NRS004", "error")]


def test_a_certificate_behind_a_link_that_leads_elsewhere(check, project, tmp_path):
    (project / "reports").rename(tmp_path / "elsewhere")
    (project / "reports").symlink_to(tmp_path / "elsewhere")
    assert broken(check()) == [("NRS105", "missed")] * 2


def test_a_missed_goal_stays_missed(project):
    text = SOFT_TISSUE.read_text().replace("768.17 N/m]}", "1500 N/m]}")
    spec = project / "specs/soft-tissue.nrs.yaml"
    spec.write_text(text)
    first = run_gate([spec], Files(project / "reports", html=False))
    write_lock(first, project / "nrs.lock")
    again = run_locked([spec], read_lock(project / "nrs.lock"), project / "nrs.lock")
    assert ("NRS103", "missed") in broken(first)
    assert broken(again) == broken(first)
    goals = [item for item in again.broken if item.rule.id == "NRS103"]
    assert all("not computed again" in item.message for item in goals)
    assert {item.line for item in goals} == {
        item.line for item in first.broken if item.rule.id == "NRS103"
    }


def test_other_commands_in_a_file_are_no_longer_what_was_locked(project):
    text = SOFT_TISSUE.read_text() + (
        "scenarios:\n  hand: {command: {csv: hand.csv}, "
        "surfaces: [{environment: soft, at: 1 deg}], limits: {torque: 0.1 N*m}}\n"
    )
    spec, lock = project / "specs/soft-tissue.nrs.yaml", project / "nrs.lock"
    hand = project / "specs/hand.csv"
    spec.write_text(text)
    hand.write_text("time_s,velocity_deg_s\n0,1\n0.5,1\n")
    write_lock(run_gate([spec], Files(project / "reports", html=False)), lock)
    assert not broken(run_locked([spec], read_lock(lock), lock))
    hand.write_text("time_s,velocity_deg_s\n0,8\n0.5,8\n")
    assert broken(run_locked([spec], read_lock(lock), lock)) == [("NRS105", "missed")]
    hand.unlink()
    assert broken(run_locked([spec], read_lock(lock), lock)) == [("NRS105", "missed")]


def test_gains_are_shown_and_are_those_of_the_certificate(check, project):
    gains = check().specs[0].gains
    assert gains["insertion"]["Bt"] == "2.150000095367431640625"
    edit_lock(project, lambda specs: specs[0]["gains"]["insertion"].update(Bt="2.125"))
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "other gains" in outcome.broken[0].message


def test_gains_without_a_certificate_are_not_shown(check, project):
    """Nothing but the lock file says that they were designed, and it may say anything."""

    def forge(specs):
        forged = {"insertion": {"Bt": "1e999999999"}}
        specs[0].update(verdict="inconclusive", rate=None, certificate=None, gains=forged)

    edit_lock(project, forge)
    outcome = check()
    assert broken(outcome) == [("NRS102", "inconclusive")]
    assert outcome.specs[0].gains == {}


def test_gains_that_another_version_designed(check, project):
    """Given matrices are not designed, so no version can change them."""
    edit_lock(project, lambda specs: [spec.update(version="0.0.1") for spec in specs])
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "may design other gains" in outcome.broken[0].message
    assert outcome.specs[1].verdict == "proved"


def test_certificate_in_other_coordinates_than_the_spec(check, project):
    from nrs_design.certificates.certificate import dump
    from nrs_design.pipeline import run_certification
    from nrs_design.spec import read_spec

    loaded = read_spec(project / "specs/soft-tissue.nrs.yaml")
    certificate = run_certification(loaded, coordinates="force").certificate
    (project / "reports/soft-tissue.cert.json").write_text(dump(certificate))
    edit_lock(project, lambda specs: specs[0]["certificate"].update(id=certificate.id))
    from nrs_design.gating.examine import certified_rate

    edit_lock(project, lambda specs: specs[0].update(rate=certified_rate(certificate)[0]))
    outcome = check()
    assert broken(outcome) == [("NRS104", "missed")]
    assert "other coordinates than deflection" in outcome.broken[0].message


def test_refuted_spec_stays_refuted(project):
    (project / "specs/unstable.nrs.yaml").write_text(UNSTABLE)
    specs = find_specs([project / "specs"])
    write_lock(run_gate(specs, Files(project / "reports", html=False)), project / "nrs.lock")
    outcome = run_locked(specs, read_lock(project / "nrs.lock"), project / "nrs.lock")
    assert broken(outcome) == [("NRS101", "refuted"), ("NRS102", "refuted")]
    assert outcome.severity == 2


def test_refutation_by_a_signal_stays_one(project):
    """All modes are stable; locked and unlocked, the signal is told."""
    (project / "specs/unstable.nrs.yaml").write_text(GROWING)
    specs = [project / "specs/unstable.nrs.yaml"]
    first = run_gate(specs, Files(project / "reports", html=False))
    write_lock(first, project / "nrs.lock")
    again = run_locked(specs, read_lock(project / "nrs.lock"), project / "nrs.lock")
    for outcome in (first, again):
        assert broken(outcome) == [("NRS102", "refuted")]
        assert "Repeating the signal" in outcome.broken[0].message
        assert (outcome.severity, outcome.specs[0].common_quadratic) == (2, "impossible")


def test_remark_of_an_inconclusive_spec_is_locked_and_checked(project):
    """No quadratic function exists, and more was not shown: the gate stays closed."""
    (project / "specs/hard.nrs.yaml").write_text(HARD)
    specs = [project / "specs/hard.nrs.yaml"]
    first = run_gate(specs, Files(project / "reports", html=False))
    write_lock(first, project / "nrs.lock")
    again = run_locked(specs, read_lock(project / "nrs.lock"), project / "nrs.lock")
    for outcome in (first, again):
        assert broken(outcome) == [("NRS102", str(Status.INCONCLUSIVE))]
        assert (outcome.severity, outcome.specs[0].common_quadratic) == (1, "impossible")
    file = project / "reports/hard.cert.json"
    file.write_text(file.read_text().replace("No positive definite Q", "Every Q"))
    altered = run_locked(specs, read_lock(project / "nrs.lock"), project / "nrs.lock")
    assert broken(altered) == [("NRS104", "missed")]


@pytest.mark.parametrize("name", ["stable", "soft-tissue"])
def test_inconclusive_spec_stays_inconclusive(project, inconclusive, name):
    spec = project / f"specs/{name}.nrs.yaml"
    outcome = run_gate([spec], Files(project / "reports", html=False))
    write_lock(outcome, project / "nrs.lock")
    again = run_locked([spec], read_lock(project / "nrs.lock"), project / "nrs.lock")
    assert broken(again) == [("NRS102", str(Status.INCONCLUSIVE))]
    assert (again.severity, again.specs[0].verdict) == (1, "inconclusive")


def test_a_defect_in_one_spec_stops_no_other(check, monkeypatch):
    from nrs_design.gating import locked

    def fail_once(path, loaded):
        if loaded.spec.name == "soft-tissue":
            raise RuntimeError("unforeseen")
        return verify(path, loaded)

    verify = locked.verify
    monkeypatch.setattr(locked, "verify", fail_once)
    outcome = check()
    assert [spec.verdict for spec in outcome.specs] == [None, "proved"]
    assert outcome.severity == 4


def test_nothing_is_written_and_no_solver_is_loaded(project):
    before = {p: p.stat().st_mtime_ns for p in project.rglob("*")}
    program = (
        "import sys\n"
        "from nrs_design.cli import main\n"
        "sys.argv = ['nrs-design', 'gate', '--locked', 'specs']\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code, end.code\n"
        "heavy = {'clarabel', 'scipy', 'control', 'matplotlib', 'cvxpy', 'typst', 'jinja2'}\n"
        "print(sorted(heavy & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=project,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.rstrip().endswith("[]")
    assert {p: p.stat().st_mtime_ns for p in project.rglob("*")} == before
