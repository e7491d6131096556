import json

import pytest

from nrs_design.certificates.verify import verify
from nrs_design.errors import InternalError
from nrs_design.gating.lock import read_lock
from nrs_design.gating.locked import run_locked
from nrs_design.gating.obligations import Status
from nrs_design.gating.renew import write_lock
from nrs_design.gating.run import Files, run_gate
from nrs_design.spec import read_spec
from nrs_design.spec.templates import TEMPLATES
from tests.pipeline.test_blocked import PAIR
from tests.simulation.interactions import text_of
from tests.support import FORCE_LIMIT, GIVEN, replaced

from .conftest import BROKEN, SOFT_TISSUE, STABLE, UNSTABLE


@pytest.fixture
def examine(tmp_path):
    """Gate the given texts as specs s0, s1, ... without reports."""

    def run(*texts):
        paths = [tmp_path / f"s{i}.nrs.yaml" for i in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text)
        return run_gate(paths, Files(folder=tmp_path / "reports", html=False))

    return run


def found(spec):
    return [(item.rule.id, item.subject, str(item.status)) for item in spec.obligations]


def test_proved_spec(examine, tmp_path):
    (spec,) = examine(STABLE).specs
    assert found(spec) == [
        ("NRS101", "a", "proved"),
        ("NRS101", "b", "proved"),
        ("NRS102", "system", "proved"),
        ("NRS104", "certificate", "met"),
    ]
    assert (spec.verdict, spec.common_quadratic, spec.modes) == ("proved", "exists", 2)
    file = tmp_path / "reports/stable.cert.json"
    assert spec.certificate == file
    assert spec.certificate_id == json.loads(file.read_text())["id"]
    assert verify(file, read_spec(spec.path)).fault is None


def test_the_outcome_is_the_same_for_any_number_of_processes(tmp_path):
    """Specs that cannot be read, share a name or are refuted are at their places."""
    texts = (STABLE, UNSTABLE, BROKEN, STABLE.replace("name: stable", "name: other"), UNSTABLE)
    paths = [tmp_path / f"s{i}.nrs.yaml" for i in range(len(texts))]
    for path, text in zip(paths, texts, strict=True):
        path.write_text(text)
    files = Files(folder=tmp_path / "reports", html=False)
    alone = run_gate(paths, files)
    assert run_gate(paths, files, jobs=2) == alone
    assert [spec.path for spec in alone.specs] == paths


def test_refuted_spec_names_the_unstable_modes_with_their_place(examine):
    outcome = examine(UNSTABLE)
    assert found(outcome.specs[0]) == [
        ("NRS101", "good", "proved"),
        ("NRS101", "bad", "refuted"),
        ("NRS102", "system", "refuted"),
        ("NRS104", "certificate", "met"),
    ]
    assert outcome.severity == 2
    bad = outcome.broken[0]
    assert UNSTABLE.split("\n")[bad.line - 1][bad.column - 1 :].startswith("{name: bad")
    assert "not Schur (eigenvalue about 1)" in bad.message


def test_inconclusive_fails(examine, inconclusive):
    outcome = examine(STABLE)
    (broken,) = outcome.broken
    assert (broken.rule.id, broken.status) == ("NRS102", Status.INCONCLUSIVE)
    assert "nothing found" in broken.message
    assert "0.25" not in broken.message, "times differ from run to run"
    assert outcome.severity == 1
    assert outcome.specs[0].certificate is None


def test_a_broken_spec_does_not_keep_the_others_from_being_examined(examine):
    outcome = examine(BROKEN, STABLE.replace("name: stable", "name: other"))
    assert [spec.verdict for spec in outcome.specs] == [None, "proved"]
    (broken,) = outcome.broken
    assert (broken.rule.id, broken.status, broken.line) == ("NRS001", Status.ERROR, 3)
    assert outcome.severity == 3


def test_missing_and_misnamed_files_are_errors(tmp_path):
    missing = tmp_path / "missing.nrs.yaml"
    not_utf8 = tmp_path / "\udcff.nrs.yaml"
    outcome = run_gate([missing, not_utf8], Files(folder=tmp_path, html=False))
    assert [spec.obligations[0].rule.id for spec in outcome.specs] == ["NRS001", "NRS001"]
    assert "not UTF-8" in outcome.specs[1].obligations[0].message


def test_two_specs_of_one_name_would_overwrite_each_other(examine, tmp_path):
    outcome = examine(STABLE, UNSTABLE, STABLE + "# the same name\n")
    assert [spec.verdict for spec in outcome.specs] == [None, "refuted", None]
    assert [(b.line, b.column) for b in outcome.broken[:2]] == [(2, 1), (2, 1)]
    first, _, last = (spec.path for spec in outcome.specs)
    assert outcome.specs[0].obligations[0].message.startswith(f"{last} is named 'stable' too")
    assert outcome.specs[2].obligations[0].message.startswith(f"{first} is named 'stable' too")
    assert not (tmp_path / "reports/stable.cert.json").exists()


def test_a_defect_of_one_examination_is_the_worst_and_stops_no_other(examine, monkeypatch):
    from nrs_design.gating import run

    def disagree(loaded, **options):
        if loaded.spec.name == "stable":
            raise InternalError("two computations disagree")
        return certify(loaded, **options)

    certify = run.run_certification
    monkeypatch.setattr(run, "run_certification", disagree)
    outcome = examine(BROKEN, STABLE.replace("name: stable", "name: other"), STABLE)
    assert [spec.verdict for spec in outcome.specs] == [None, "proved", None]
    assert [item.rule.id for item in outcome.broken] == ["NRS900", "NRS001"]
    assert outcome.severity == 4


def test_what_the_clock_stops_is_inconclusive_and_stops_no_other(examine, monkeypatch):
    # Each search has a fuse of its own, and may look at it many times.
    ticks = iter([*[0.0] * 3, *[1e6] * 10**6])
    monkeypatch.setattr("nrs_design.work.monotonic", lambda: next(ticks))
    outcome = examine(STABLE.replace("name: stable", "name: other"), STABLE)
    assert [spec.verdict for spec in outcome.specs] == [None, "proved"]
    (broken,) = outcome.broken
    assert (broken.rule.id, broken.status) == ("NRS008", Status.INCONCLUSIVE)
    assert "the clock stopped this" in broken.message
    assert outcome.severity == 1


def test_a_certificate_that_does_not_hold_when_read_back_is_reported(examine, monkeypatch):
    from nrs_design.certificates.certificate import dump
    from nrs_design.gating import run

    def other(*given):
        return dump(*given).replace("matrices.given", "matrices.guessed")

    monkeypatch.setattr(run, "dump", other)
    outcome = examine(STABLE)
    (broken,) = outcome.broken
    assert (broken.rule.id, broken.status) == ("NRS104", Status.MISSED)


def test_unwritable_folder_is_an_error_of_every_spec(tmp_path):
    spec = tmp_path / "s.nrs.yaml"
    spec.write_text(STABLE)
    outcome = run_gate([spec], Files(folder=spec / "reports", html=False))
    assert outcome.broken[0].rule.id == "NRS005"
    assert outcome.broken[0].line is None
    assert outcome.severity == 3


class TestStiffnessRange:
    def test_goal_is_met_but_not_called_proved(self, tmp_path):
        (spec,) = run_gate([SOFT_TISSUE], Files(folder=tmp_path, html=False)).specs
        goals = [item for item in spec.obligations if item.rule.id == "NRS103"]
        assert [item.subject for item in goals] == ["insertion", "withdrawal"]
        assert {item.status for item in goals} == {Status.MET}
        assert all("not a proof" in item.message for item in goals)
        # 768.17 N/m at 0.24 m (thesis 6.1 and 6.3.1).
        assert all("up to 44.2466 N*m/rad" in item.message for item in goals)


class TestDoubts:
    """A range whose identification is in doubt, with and without a reason."""

    def given(self, reason=""):
        lines = f'    doubts: ["a: force and deflection have opposite signs"]\n{reason}'
        return SOFT_TISSUE.read_text().replace(
            "    model: elastic\n", f"    model: elastic\n{lines}"
        )

    def test_fails_the_gate_at_its_place_though_stability_is_proved(self, examine):
        outcome = examine(self.given())
        assert (outcome.specs[0].verdict, outcome.severity) == ("proved", 2)
        (missed,) = outcome.broken
        assert (missed.rule.id, missed.subject) == ("NRS107", "soft")
        assert "opposite signs" in missed.message
        assert self.given().splitlines()[missed.line - 1].strip().startswith("doubts:")

    def test_passes_with_a_reason_which_stands_in_the_certificate(self, examine):
        outcome = examine(self.given("    accept_doubt: a phantom of gel\n"))
        assert outcome.severity == 0
        (met,) = (item for item in outcome.specs[0].obligations if item.rule.id == "NRS107")
        assert "accepted because: a phantom of gel" in met.message
        written = outcome.specs[0].certificate.read_text()
        assert "accepted because: a phantom of gel" in written


GOALS = "goals: {max_sensitivity_peak: 2, min_delay_margin: 5 ms}\nswitching: arbitrary"


class TestGoals:
    """Mt = 0.01, Bt = 1.04 has Ms 3.58 at the nominal stiffness (thesis 6.3.2.1)."""

    def given(self):
        text = SOFT_TISSUE.read_text().replace("switching: arbitrary", GOALS)
        head, tail = text.split("  withdrawal:")
        return f"{head}  withdrawal:{replaced(tail, *GIVEN)}"

    def test_each_goal_of_each_controller_is_an_obligation(self, examine):
        text = self.given()
        outcome = examine(text)
        goals = [item for item in outcome.specs[0].obligations if item.rule.id == "NRS106"]
        assert [(item.subject, str(item.status)) for item in goals] == [
            ("insertion: max_sensitivity_peak", "met"),
            ("insertion: min_delay_margin", "met"),
            ("withdrawal: max_sensitivity_peak", "missed"),
            ("withdrawal: min_delay_margin", "met"),
        ]
        bases = ["proved over all ranges"] * 2 + ["floating point, not a proof"]
        bases.append("proved over all ranges")
        assert [basis in item.message for basis, item in zip(bases, goals, strict=True)] == [
            True
        ] * 4
        assert "3.753 at worst, in soft, k = 44.2466 N*m/rad; at most 2" in goals[2].message
        # It fails the gate with its place, though stability is proved.
        assert (outcome.specs[0].verdict, outcome.severity) == ("proved", 2)
        (missed,) = outcome.broken
        line = text.split("\n")[missed.line - 1]
        assert line.startswith("max_sensitivity_peak", missed.column - 1)

    @pytest.mark.slow
    def test_gains_that_are_designed_meet_their_goals(self, examine):
        text = SOFT_TISSUE.read_text().replace("switching: arbitrary", GOALS)
        assert examine(text).severity == 0


def test_what_is_doubtful_breaks_nothing(examine):
    hand = "environments:\n  hand: {model: elastic, stiffness: 60 N*m/rad}\n"
    text = SOFT_TISSUE.read_text().replace("environments:\n", hand)
    outcome = examine(text)
    assert outcome.severity == 0
    cautions = outcome.specs[0].cautions
    messages = [item.message for item in cautions]
    (place,) = (k for k, text in enumerate(messages) if "hand is touched by no" in text)
    assert text.split("\n")[cautions[place].line - 1].startswith("  hand:")
    # What is furthest beyond its limit leads.
    assert messages[0].startswith("withdrawal: sensitivity peak Ms 3.753")


def test_contact_that_must_be_kept_is_told_unless_the_spec_says_so(examine):
    text, said = FORCE_LIMIT.read_text(), "proved for contact that is kept"
    (silent,) = examine(text).specs
    assert [item.message.startswith(said) for item in silent.cautions].count(True) == 1
    assert silent.cautions[0].line == 2
    (explicit,) = examine(text + "\ncontact: kept\n").specs
    assert not any(item.message.startswith(said) for item in explicit.cautions)
    # Its proof covers the loss of contact.
    (losable,) = examine(SOFT_TISSUE.read_text()).specs
    assert not any(item.message.startswith(said) for item in losable.cautions)


def test_fixed_gains_that_are_unstable_are_refuted_not_an_error(examine):
    stiff = ("{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}", "2000 N/m")
    (spec,) = examine(replaced(SOFT_TISSUE.read_text(), stiff, *GIVEN)).specs
    assert spec.verdict == "refuted"
    assert ("NRS103", "controllers", "missed") in found(spec)


def test_a_design_without_answer_names_file_and_controller(examine, tmp_path):
    text = SOFT_TISSUE.read_text()
    text = text.replace("Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}", "Bt: 0.001 N*m*s/rad", 1)
    (spec,) = examine(text).specs
    (broken,) = [item for item in spec.obligations if item.status is Status.ERROR]
    assert "controller insertion" in broken.message
    assert broken.path == tmp_path / "s0.nrs.yaml"


def test_a_robot_has_nothing_to_certify_and_is_not_locked(examine, tmp_path):
    outcome = examine(TEMPLATES["robot"], STABLE)
    robot, stable = outcome.specs
    assert (outcome.severity, found(robot)) == (0, [("NRS001", "spec", "met")])
    assert (robot.verdict, robot.certifiable, stable.verdict) == (None, False, "proved")
    assert not (tmp_path / "reports" / "my-robot.cert.json").exists()
    file = tmp_path / "nrs.lock"
    write_lock(outcome, file)
    assert [spec.path for spec in read_lock(file).specs] == ["s1.nrs.yaml"]
    paths = [spec.path for spec in outcome.specs]
    again = run_locked(paths, read_lock(file), file)
    assert again.severity == 0
    assert found(again.specs[0]) == [("NRS001", "spec", "met")]


LIMITED = (
    "command: {constant: 8 deg/s}, duration: 0.2 s, surfaces: [{environment: soft, at: 0.1 deg}], "
    "limits: {LIMITS}"
)


def limited(limits):
    law = {"insertion": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}"}
    return text_of(law, scenario=LIMITED.replace("LIMITS", limits))


@pytest.mark.parametrize(
    ("limits", "statuses"),
    [("torque: 0.5 N*m", ["met"]), ("torque: 0.1 N*m, velocity: 20 deg/s", ["missed", "met"])],
)
def test_a_scenario_is_held_against_its_limits(examine, tmp_path, limits, statuses):
    """The gate simulates it; --locked says how it ended, and does not simulate."""
    outcome = examine(limited(limits))
    mine = [item for item in outcome.specs[0].obligations if item.rule.id == "NRS109"]
    assert [str(item.status) for item in mine] == statuses
    assert mine[0].subject == "run: torque"
    assert "not a proof" in mine[0].message
    lock = tmp_path / "nrs.lock"
    write_lock(outcome, lock)
    again = run_locked([tmp_path / "s0.nrs.yaml"], read_lock(lock), lock)
    locked = [item for item in again.specs[0].obligations if item.rule.id == "NRS109"]
    assert [(item.subject, str(item.status)) for item in locked] == [
        (item.subject, str(item.status)) for item in mine
    ]
    assert all("not computed again" in item.message for item in locked)
    assert locked[0].line == mine[0].line
    free = limited(limits).replace(f", limits: {{{limits}}}", "")
    assert "NRS109" not in {item.rule.id for item in examine(free).specs[0].obligations}


@pytest.mark.slow
def test_lines_that_block_a_proof_are_said_and_the_gate_fails(examine):
    (spec,) = examine(PAIR).specs
    (stable,) = (o for o in spec.obligations if o.rule.id == "NRS102")
    assert stable.status is Status.INCONCLUSIVE
    assert "; proved with any one of these changes; " in stable.message
    assert "s0.nrs.yaml:7: switching.dwell_time: with 2.91 s" in stable.message
