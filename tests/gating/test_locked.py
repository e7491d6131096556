import json

import pytest

from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.lock import read_lock
from nrs_design.gating.locked import find_missing, run_locked
from nrs_design.gating.obligations import Status
from nrs_design.gating.renew import write_lock
from nrs_design.spec import read_spec
from tests.support import ROOT, SOFT_TISSUE, spec_in, started

from .conftest import gate_of, restated

# Of the pair of modes.
CERTIFICATE = "reports/stable.cert.json"


@pytest.fixture
def check(project):
    def run(*names):
        specs = find_specs([project / name for name in names or ("specs",)])
        lock = project / "nrs.lock"
        named = [project / name for name in names or ("specs",)]
        return run_locked(specs, read_lock(lock), lock, paths=named)

    return run


def broken(outcome):
    return [(item.rule.id, str(item.status)) for item in outcome.broken]


def gate_twice(project, spec):
    """Gate a spec and lock it; return what was found, and what is found again."""
    lock = project / "nrs.lock"
    first = gate_of(project, spec)
    write_lock(first, lock)
    return first, run_locked([spec], read_lock(lock), lock)


def edit_lock(project, edit):
    document = json.loads((project / "nrs.lock").read_text())
    edit(document["specs"])
    (project / "nrs.lock").write_text(json.dumps(document))


def test_false_certificate_with_a_lock_to_match(check, project):
    def flip(document):
        numerators = document["statements"][0]["nodes"][0]["form"]
        numerators[0][0] = -numerators[0][0]

    new = restated(project / CERTIFICATE, flip)
    edit_lock(project, lambda specs: specs[1]["certificate"].update(id=new))
    assert broken(check()) == [("NRS104", "missed")]


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
    done = started("-c", program, cwd=project, PYTHONDONTWRITEBYTECODE="1")
    assert done.returncode == 0, done.stderr
    assert done.stdout.rstrip().endswith("[]")
    assert {p: p.stat().st_mtime_ns for p in project.rglob("*")} == before


GOALS = "goals: {max_sensitivity_peak: 9}"
RUN = """scenarios:
  hit: {command: {constant: 8 deg/s}, duration: 1 s, limits: {torque: 1 N*m, velocity: 9 deg/s}}
"""


def asked(tmp_path, text, locked=(), status="missed"):
    path = spec_in(tmp_path, text, "s")
    known = {locked: status} if locked else {}
    return [f"{rule} {subject}" for rule, subject in find_missing(read_spec(path).spec, known)]


def test_every_shipped_lock_says_what_its_spec_asks():
    entries = read_lock(ROOT / "nrs.lock").specs
    for entry in entries:
        spec = read_spec(ROOT / entry.path).spec
        locked = [(goal.rule, goal.subject) for goal in entry.goals]
        assert find_missing(spec, dict.fromkeys(locked, "met")) == ()
        # Whichever is gone is missing.
        for index in range(len(locked)):
            rest = locked[:index] + locked[index + 1 :]
            assert find_missing(spec, dict.fromkeys(rest, "met")) == (locked[index],)


def test_goals_of_the_spec_and_limits_of_runs_are_asked(tmp_path):
    text = f"{SOFT_TISSUE.read_text()}{GOALS}\n{RUN}"
    controllers = [
        f"{rule} {name}"
        for name in ("insertion", "withdrawal")
        for rule, name in (("NRS103", name), ("NRS106", f"{name}: max_sensitivity_peak"))
    ]
    limits = ["NRS109 hit: torque", "NRS109 hit: velocity"]
    assert asked(tmp_path, text) == [*controllers, *limits]
    assert asked(tmp_path, text, ("NRS103", "controllers")) == limits
    assert asked(tmp_path, text, ("NRS109", "hit")) == controllers
    # What was never judged is not met, whatever a lock says.
    for stand_in in (("NRS103", "controllers"), ("NRS109", "hit")):
        assert asked(tmp_path, text, stand_in, "met") == [*controllers, *limits]


@pytest.mark.parametrize(("outer", "limited"), [("1 ms", False), ("4 ms", True)])
def test_no_limit_where_the_force_is_sampled_more_often(tmp_path, outer, limited):
    text = (
        SOFT_TISSUE.read_text() + f"sampling: {{period: 2 ms, delay: 0, outer_period: {outer}}}\n"
    )
    assert ("NRS103 insertion" in asked(tmp_path, text)) is limited
