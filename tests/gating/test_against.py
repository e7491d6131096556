"""What a pull request makes weaker, beside the base that it wants to change."""

import json
import shutil
from pathlib import Path

import pytest

from nrs_design.gating.against import compare_with_base
from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.lock import read_lock
from nrs_design.gating.locked import run_locked

LOCK = Path("nrs.lock")


@pytest.fixture
def folders(project, tmp_path_factory, monkeypatch):
    """The folder of a pull request, which is the working folder, and the base that it is from."""
    base = tmp_path_factory.mktemp("base") / "base"
    shutil.copytree(project, base)
    monkeypatch.chdir(project)
    return project, base


def weaker(outcome):
    return [item for item in outcome.broken if item.rule.id == "NRS110"]


def test_a_proof_that_covers_less_than_that_of_the_base(folders):
    """The spec leaves open whether contact is kept, so a proof of that alone is accepted."""
    base, paths = folders[1], [Path("specs")]
    outcome = run_locked(find_specs(paths), read_lock(LOCK), LOCK, paths=paths)
    file = Path("reports/soft-tissue.cert.json")
    document = json.loads(file.read_text())
    document["statements"][0]["nodes"].pop()
    file.write_text(json.dumps(document))
    (item,) = weaker(compare_with_base(outcome, paths, base, LOCK))
    assert item.message == "loss of contact covered before, not shown now"
    (base / file).unlink()
    (item,) = weaker(compare_with_base(outcome, paths, base, LOCK))
    assert item.message.startswith("the certificate of the base cannot be compared: cannot be read")
