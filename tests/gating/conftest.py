"""A project with two small specs that has passed the gate once."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.obligations import GateOutcome
from nrs_design.gating.renew import make_lock, write_lock
from nrs_design.gating.run import Files, run_gate
from tests.support import SOFT_TISSUE, replaced
from tests.tables import spec_text

# `growing` is of Branicky 1998: both modes are Hurwitz.
STABLE, UNSTABLE, GROWING = map(spec_text, ("stable", "unstable", "growing"))
# Dayawansa and Martin 1999 with a = 11.2: stable, but beyond the degrees that are tried.
HARD = GROWING.replace("growing", "hard").replace("[[-1, 10], [-100, -1]]", "[[-1, -1], [1, -1]]")
HARD = HARD.replace("[[-1, 100], [-10, -1]]", "[[-1, -11.2], [5/56, -1]]")
HARD += "certification: {max_degree: 8}\n"
BROKEN = STABLE.replace("time: continuous", "time: sideways")


@pytest.fixture(scope="session")
def gated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with specs, certificates and nrs.lock; never to be changed."""
    root = tmp_path_factory.mktemp("gated")
    folder = root / "specs"
    folder.mkdir()
    (folder / "stable.nrs.yaml").write_text(STABLE)
    shutil.copy(SOFT_TISSUE, folder)
    outcome = gate_of(root, *find_specs([folder]))
    write_lock(outcome, root / "nrs.lock")
    assert make_lock(outcome.specs, root / "nrs.lock").specs
    return root


@pytest.fixture
def project(gated: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the gated folder, and the working folder."""
    root = tmp_path / "project"
    shutil.copytree(gated, root)
    monkeypatch.chdir(root)
    return root


def restated(file: Path, change: Callable[[dict[str, Any]], object]) -> str:
    """Change a certificate, and return the id that follows, which it has then."""
    document = json.loads(file.read_text())
    change(document)
    document["id"] = content_id(document)
    file.write_text(json.dumps(document, indent=2) + "\n")
    return document["id"]


def gate_of(folder: Path, *specs: Path, reports: str = "reports") -> GateOutcome:
    """Run the gate on specs, without pages."""
    return run_gate(specs, Files(folder=folder / reports, html=False))


def edit(path: Path, old: str, new: str) -> None:
    path.write_text(replaced(path.read_text(encoding="utf-8"), (old, new)), encoding="utf-8")


@pytest.fixture
def inconclusive(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let every search end without a proof and without a refutation."""
    from nrs_design.certificates.certificate import CommonQuadraticStatus, Verdict
    from nrs_design.search.certification import Attempt, Certification

    def give_up(system, *arguments, **options):
        attempts = (Attempt("lmi", "nothing found", 0.25),)
        return Certification(
            system, Verdict.INCONCLUSIVE, CommonQuadraticStatus.UNKNOWN, "auto", (), attempts
        )

    monkeypatch.setattr("nrs_design.search.certify.certify", give_up)
