import json
import os
import shutil
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


def gate_twice(project, spec):
    """Gate a spec and lock it; return what was found, and what is found again."""
    lock = project / "nrs.lock"
    first = run_gate([spec], Files(folder=project / "reports", html=False))
    write_lock(first, lock)
    return first, run_locked([spec], read_lock(lock), lock)


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


SPEC, PROOF = "specs/stable.nrs.yaml", "reports/stable.cert.json"


def write(name, text):
    return lambda project: (project / name).write_text(text)


def relock(**change):
    return lambda project: edit_lock(project, lambda specs: specs[1].update(change))


def move(certificate):
    return lambda project: edit_lock(
        project, lambda specs: specs[1]["certificate"].update(file=certificate)
    )


def forget(project):
    edit_lock(project, lambda specs: specs[0]["goals"].pop())


# What was done to a project; which obligations break; and what is said of the first.
TAMPERED = {
    "a changed spec": (
        write(SPEC, STABLE.replace("[-2, 3]", "[-2, 3.0]")),
        [("NRS105", "missed")],
        "has changed since it was locked",
    ),
    # What makes no claim passes, but not in place of a claim that was locked.
    "a spec that is now a robot": (
        write(SPEC, TEMPLATES["robot"]),
        [("NRS105", "missed")],
        "has changed since it was locked",
    ),
    "a goal that is no longer locked": (
        forget,
        [("NRS105", "missed")],
        "does not say how this ended: NRS103 of withdrawal",
    ),
    "a new spec": (
        write("specs/new.nrs.yaml", UNSTABLE),
        [("NRS105", "missed")],
        "is not in nrs.lock",
    ),
    "a spec that is gone": (
        lambda project: (project / SPEC).unlink(),
        [("NRS105", "missed")],
        "no longer exists",
    ),
    "a renamed spec": (
        lambda project: (project / SPEC).rename(project / "specs/other.nrs.yaml"),
        [("NRS105", "missed")] * 2,
        "is not in nrs.lock",
    ),
    "no certificate": (
        lambda project: (project / PROOF).unlink(),
        [("NRS004", "error")],
        "cannot be read",
    ),
    "a certificate that is no JSON": (write(PROOF, "{"), [("NRS004", "error")], ""),
    "an edited certificate": (
        lambda project: (project / PROOF).write_text(
            (project / PROOF).read_text().replace("matrices.given", "matrices.guessed")
        ),
        [("NRS104", "missed")],
        "is rejected",
    ),
    "the certificate of another spec": (
        lambda project: shutil.copy(project / "reports/soft-tissue.cert.json", project / PROOF),
        [("NRS104", "missed")],
        "is rejected",
    ),
    "a better rate": (relock(rate="99"), [("NRS105", "missed")], "another verdict or rate"),
    "no rate": (relock(rate=None), [("NRS105", "missed")], "another verdict or rate"),
    "another verdict": (relock(verdict="refuted"), [("NRS105", "missed")], "another verdict"),
    "a forged hash": (relock(sha256="0" * 64), [("NRS105", "missed")], "has changed"),
    "a dropped entry": (
        lambda project: edit_lock(project, lambda specs: specs.pop()),
        [("NRS105", "missed")],
        "is not in nrs.lock",
    ),
    "no such certificate": (move("nowhere"), [("NRS004", "error")], ""),
    "a folder for a certificate": (move("reports"), [("NRS004", "error")], ""),
    "an endless name": (move("x" * 4000), [("NRS004", "error")], ""),
    # Given matrices are not designed, so no version can change them.
    "another version": (
        lambda project: edit_lock(
            project, lambda specs: [spec.update(version="0.0.1") for spec in specs]
        ),
        [("NRS105", "missed")],
        "may design other gains",
    ),
}


@pytest.mark.parametrize("case", TAMPERED)
def test_what_differs_from_what_was_locked_fails_with_its_reason(check, project, case):
    tamper, expected, words = TAMPERED[case]
    tamper(project)
    outcome = check()
    assert broken(outcome) == expected
    assert words in outcome.broken[0].message
    assert all(not item.path.is_absolute() for item in outcome.broken if "exists" in words)


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


def test_valid_certificate_other_than_the_locked_one(check, project):
    def scale(document):
        document["statements"][0]["denominator_log2"] += 1

    new = edit_certificate(project, scale)
    outcome = check()
    assert broken(outcome) == [("NRS105", "missed")]
    assert "not the certificate that was locked" in outcome.broken[0].message
    # Locked by its id, it holds: a scaled function proves the same.
    edit_lock(project, lambda specs: specs[1]["certificate"].update(id=new))
    assert check().severity == 0


def test_false_certificate_with_a_lock_to_match(check, project):
    def flip(document):
        numerators = document["statements"][0]["nodes"][0]["form"]
        numerators[0][0] = -numerators[0][0]

    new = edit_certificate(project, flip)
    edit_lock(project, lambda specs: specs[1]["certificate"].update(id=new))
    assert broken(check()) == [("NRS104", "missed")]


def test_a_certificate_behind_a_link_that_leads_elsewhere(check, project, tmp_path):
    (project / "reports").rename(tmp_path / "elsewhere")
    (project / "reports").symlink_to(tmp_path / "elsewhere")
    assert broken(check()) == [("NRS105", "missed")] * 2


def test_other_commands_in_a_file_are_no_longer_what_was_locked(project):
    text = SOFT_TISSUE.read_text() + (
        "scenarios:\n  hand: {command: {csv: hand.csv}, "
        "surfaces: [{environment: soft, at: 1 deg}], limits: {torque: 0.1 N*m}}\n"
    )
    spec, lock = project / "specs/soft-tissue.nrs.yaml", project / "nrs.lock"
    hand = project / "specs/hand.csv"
    spec.write_text(text)
    hand.write_text("time_s,velocity_deg_s\n0,1\n0.5,1\n")
    assert not broken(gate_twice(project, spec)[1])
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


@pytest.mark.parametrize(
    ("text", "expected", "words"),
    [
        (UNSTABLE, [("NRS101", "refuted"), ("NRS102", "refuted")], "mode bad is not Schur"),
        # All modes are stable; the signal that grows is told.
        (GROWING, [("NRS102", "refuted")], "Repeating the signal"),
    ],
)
def test_a_refuted_spec_stays_refuted(project, text, expected, words):
    spec = project / "specs/unstable.nrs.yaml"
    spec.write_text(text)
    for outcome in gate_twice(project, spec):
        assert broken(outcome) == expected
        assert words in outcome.broken[0].message
        assert (outcome.severity, outcome.specs[0].common_quadratic) == (2, "impossible")


def test_remark_of_an_inconclusive_spec_is_locked_and_checked(project):
    """No quadratic function exists, and more was not shown: the gate stays closed."""
    (project / "specs/hard.nrs.yaml").write_text(HARD)
    specs = [project / "specs/hard.nrs.yaml"]
    for outcome in gate_twice(project, *specs):
        assert broken(outcome) == [("NRS102", str(Status.INCONCLUSIVE))]
        assert (outcome.severity, outcome.specs[0].common_quadratic) == (1, "impossible")
    file = project / "reports/hard.cert.json"
    file.write_text(file.read_text().replace("No positive definite Q", "Every Q"))
    altered = run_locked(specs, read_lock(project / "nrs.lock"), project / "nrs.lock")
    assert broken(altered) == [("NRS104", "missed")]


@pytest.mark.parametrize("name", ["stable", "soft-tissue"])
def test_inconclusive_spec_stays_inconclusive(project, inconclusive, name):
    spec = project / f"specs/{name}.nrs.yaml"
    (project / f"reports/{name}.cert.json").unlink()
    _, again = gate_twice(project, spec)
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
        "heavy = {'clarabel', 'scipy', 'control', 'matplotlib', 'cvxpy', 'jinja2'}\n"
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
