from pathlib import Path

import pytest

from nrs_design.gating.obligations import GateOutcome, SpecOutcome, Status, failed
from tests.gating.formats.support import obligation

STATUSES = [Status.INCONCLUSIVE, Status.ERROR, Status.REFUTED, Status.PROVED, Status.MISSED]


@pytest.fixture
def mixed():
    """One spec of every kind of end."""
    good = SpecOutcome(
        Path("specs/good.nrs.yaml"),
        (obligation(Status.PROVED, "specs/good.nrs.yaml"),),
        sha256="0" * 64,
        verdict="proved",
        common_quadratic="exists",
        rate="1.5",
        rate_name="alpha",
        modes=2,
        certificate=Path("reports/good.cert.json"),
        certificate_id="abcdef0123456789",
    )
    bad = SpecOutcome(Path("specs/a.nrs.yaml"), tuple(map(obligation, STATUSES)), verdict="refuted")
    defect = failed(Path("specs/c.nrs.yaml"), RuntimeError("unforeseen\nand long"))
    return GateOutcome((bad, good, defect), ("a note",))
