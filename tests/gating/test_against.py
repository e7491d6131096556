"""What a pull request makes weaker, beside the base that it wants to change."""

import json
import shutil
from pathlib import Path

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.gating.against import base_paths, compare_with_base
from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.formats import FORMATS
from nrs_design.gating.lock import read_lock
from nrs_design.gating.locked import run_locked

from .conftest import BROKEN, GROWING, STABLE, edit

LOCK = Path("nrs.lock")


@pytest.fixture
def folders(project, tmp_path_factory, monkeypatch):
    """The folder of a pull request, which is the working folder, and the base that it is from."""
    base = tmp_path_factory.mktemp("base") / "base"
    shutil.copytree(project, base)
    monkeypatch.chdir(project)
    return project, base


def against(base, *names):
    paths = [Path(name) for name in names or ("specs",)]
    outcome = run_locked(find_specs(paths), read_lock(LOCK), LOCK, named=paths)
    return compare_with_base(outcome, paths, base, LOCK)


def weaker(outcome):
    return [item for item in outcome.broken if item.rule.id == "NRS110"]


def test_the_same_is_not_weaker(folders):
    _, base = folders
    outcome = against(base)
    assert outcome.severity == 0
    assert (outcome.changes.weaker, outcome.changes.others) == (0, ())
    assert f"against {base.as_posix()}: 0 weaker (NRS110), 0 other changes\n" in FORMATS["text"](
        outcome
    )


def test_what_is_weaker_has_its_place_in_every_format(folders):
    """A narrower range passes every other rule once it is proved and locked."""
    head, base = folders
    spec = head / "specs/soft-tissue.nrs.yaml"
    edit(spec, "[720.56 N/m, 768.17 N/m]", "[740 N/m, 768.17 N/m]")
    edit(spec, "time_constant: 0.0351 s", "time_constant: 0.0352 s")
    outcome = against(base)
    line = next(n for n, text in enumerate(spec.read_text().split("\n"), 1) if "[740" in text)
    item = next(item for item in weaker(outcome) if "values of before" in item.message)
    assert (item.line, item.subject) == (line, "environments.soft.stiffness")
    assert outcome.severity == 2
    (other,) = outcome.changes.others
    assert other.message == "actuator.time_constant: '0.0351 s' before, '0.0352 s' now"
    text = FORMATS["text"](outcome)
    assert f"soft-tissue.nrs.yaml:{line}:5: NRS110 missed: environments.soft.stiffness" in text
    assert f":{other.line}:{other.column}: actuator.time_constant" in text
    document = json.loads(FORMATS["json"](outcome))["against"]
    assert document["weaker"] == outcome.changes.weaker == len(weaker(outcome))
    assert [one["message"] for one in document["others"]] == [other.message]
    annotations = FORMATS["github"](outcome).splitlines()
    assert any(a.startswith("::error") and "NRS110" in a for a in annotations)
    assert any(a.startswith("::warning") and "time_constant" in a for a in annotations)
    assert all("NRS110" in FORMATS[name](outcome) for name in ("sarif", "junit"))


@pytest.mark.parametrize("locked", [True, False])
def test_a_spec_that_is_gone(folders, locked):
    head, base = folders
    (head / "specs/stable.nrs.yaml").unlink()
    if not locked:
        document = json.loads(LOCK.read_text())
        document["specs"] = [one for one in document["specs"] if "stable" not in one["path"]]
        LOCK.write_text(json.dumps(document))
    (item,) = weaker(against(base))
    assert "this spec of the base is gone" in item.message
    assert item.path == Path("specs/stable.nrs.yaml")


def test_the_folder_that_is_gone_is_gone_with_all_its_specs(folders):
    _, base = folders
    (base / "specs/more").mkdir()
    (base / "specs/more/other.nrs.yaml").write_text(STABLE.replace("stable", "other"))
    assert [item.path for item in weaker(against(base))] == [Path("specs/more/other.nrs.yaml")]


def test_a_spec_that_has_moved_is_compared_where_it_is(folders):
    head, base = folders
    (head / "specs/new").mkdir()
    (head / "specs/stable.nrs.yaml").rename(head / "specs/new/stable.nrs.yaml")
    edit(head / "specs/new/stable.nrs.yaml", "arbitrary", "{dwell_time: 1 s}")
    LOCK.write_text(json.dumps({"schema": "nrs-design/lock/2", "specs": []}))
    messages = [item.message for item in weaker(against(base)) if "stable" in str(item.path)]
    assert messages[0].startswith("switching: 'arbitrary' before, '{dwell_time: 1 s}' now")
    assert not any("gone" in message for message in messages)


def test_a_verdict_and_a_rate_of_the_base(folders):
    head, base = folders
    document = json.loads((base / "nrs.lock").read_text())
    for entry in document["specs"]:
        entry["version"] = "0.0.0"
        edit(base / entry["certificate"]["file"], '"rate": "', '"rate": "1000')
    (base / "nrs.lock").write_text(json.dumps(document))
    outcome = against(base)
    assert [item.message[:14] for item in weaker(outcome)] == ["certified rate"] * 2
    assert {other.message.split(" before")[0] for other in outcome.changes.others} == {
        "designed by nrs-design 0.0.0"
    }
    (head / "specs/stable.nrs.yaml").write_text(GROWING.replace("growing", "stable"))
    found = [item.message for item in weaker(against(base))]
    assert "proved before, without a verdict now" in found


def test_a_proof_that_covers_less_than_that_of_the_base(folders):
    """The spec leaves open whether contact is kept, so a proof of that alone is accepted."""
    base, paths = folders[1], [Path("specs")]
    outcome = run_locked(find_specs(paths), read_lock(LOCK), LOCK, named=paths)
    file = Path("reports/soft-tissue.cert.json")
    document = json.loads(file.read_text())
    document["statements"][0]["nodes"].pop()
    file.write_text(json.dumps(document))
    (item,) = weaker(compare_with_base(outcome, paths, base, LOCK))
    assert item.message == "loss of contact covered before, not shown now"
    (base / file).unlink()
    (item,) = weaker(compare_with_base(outcome, paths, base, LOCK))
    assert item.message.startswith("the certificate of the base cannot be compared: cannot be read")


@pytest.mark.parametrize("where", ["base", "head"])
def test_a_spec_that_cannot_be_read(folders, where):
    head, base = folders
    ((base if where == "base" else head) / "specs/stable.nrs.yaml").write_text(BROKEN)
    found = [item.message for item in weaker(against(base))]
    expected = "cannot be compared" if where == "base" else "without a verdict now"
    assert any(expected in message for message in found)


def test_a_base_that_is_none(folders):
    head, base = folders
    for paths, where, said in (
        (["specs"], base / "nothing", "is not a folder"),
        (["specs"], head, "is this folder itself"),
        ([base / "specs"], base, "is not below the working folder"),
    ):
        with pytest.raises(NrsDesignError, match=said):
            base_paths([Path(path) for path in paths], where)


@pytest.mark.parametrize("linked", ["specs", "specs/stable.nrs.yaml"])
def test_a_link_to_the_base_is_not_compared_with_it(folders, linked):
    """It would be found the same, and is none of it in the repository."""
    head, base = folders
    if (head / linked).is_dir():
        shutil.rmtree(head / linked)
    else:
        (head / linked).unlink()
    (head / linked).symlink_to(base / linked)
    with pytest.raises(NrsDesignError, match="is a link that leads out of the working folder"):
        base_paths([Path(linked)], base)


def test_a_base_that_is_not_read_any_more_is_not_taken_for_weaker(folders):
    """What an older release knew and this one does not may have been asked for."""
    _, base = folders
    edit(base / "specs/stable.nrs.yaml", "switching:", "coupling: {axes: 3}\nswitching:")
    (item,) = weaker(against(base))
    assert "that of the base cannot be read" in item.message
