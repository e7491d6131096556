import math
import threading
from dataclasses import replace

import pytest

from nrs_design.errors import OutputError
from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.lock import LockedRemark, dump_lock, read_lock
from nrs_design.gating.obligations import Caution
from nrs_design.gating.renew import check_folder, make_lock, recorded_in, write_lock
from nrs_design.output import lock_folder

from .conftest import gate_of

STABLE_SPEC = "specs/stable.nrs.yaml"


def outcome_of(project, *names, reports="reports"):
    specs = find_specs([project / name for name in names])
    return gate_of(project, *specs, reports=reports)


def test_a_remark_on_a_value_without_bound_reads_back(project):
    file, (spec,) = project / "nrs.lock", outcome_of(project, STABLE_SPEC).specs
    far = Caution(spec.path, "Ms unbounded", 1, 1, beyond=math.inf, at=("controllers", "a"))
    file.write_text(dump_lock(make_lock([replace(spec, cautions=(far,))], file)))
    remark = read_lock(file).specs[0].remark
    assert remark == LockedRemark(message="Ms unbounded", at=["controllers", "a"], beyond=1e6)


def test_what_another_run_has_replaced_is_not_locked(project):
    """Two runs in one tree: the certificate on the disk must be the one that is locked."""
    outcome = outcome_of(project, STABLE_SPEC)
    lock, file = project / "nrs.lock", project / "reports/stable.cert.json"
    before, ours = lock.read_bytes(), file.read_text()
    file.write_text(ours.replace(outcome.specs[0].certificate_id, 64 * "0"))
    for _ in range(2):
        with pytest.raises(OutputError, match=r"nothing is locked: another run works in this tree"):
            write_lock(outcome, lock)
        assert lock.read_bytes() == before
        file.unlink(missing_ok=True)
    file.write_text(ours)
    write_lock(outcome, lock)
    assert lock.read_bytes() == before


def test_nobody_reads_a_lock_that_another_run_is_about_to_write(project):
    """What was locked in between would be lost."""
    lock = project / "nrs.lock"
    whole = lock.read_bytes()
    lock.unlink()
    names = ("specs/stable.nrs.yaml", "specs/soft-tissue.nrs.yaml")
    one, other = (outcome_of(project, name) for name in names)
    with lock_folder(project):
        waiting = threading.Thread(target=write_lock, args=(one, lock))
        waiting.start()
        waiting.join(0.1)
        assert waiting.is_alive()
        assert not lock.exists()
    waiting.join()
    write_lock(other, lock)
    assert lock.read_bytes() == whole


@pytest.mark.parametrize(
    ("folder", "lock"), [("certs", "ci/a.lock"), ("..", "nrs.lock"), ("/tmp", "nrs.lock")]
)
def test_certificates_that_a_lock_could_not_name(project, folder, lock):
    with pytest.raises(OutputError, match="below the folder of the lock"):
        check_folder(project / folder, project / lock)
    for below in (".", "certs", "a/b"):
        check_folder(project / below, project / "nrs.lock")


def test_whose_a_locked_certificate_is(project):
    found = recorded_in(read_lock(project / "nrs.lock"), project / "nrs.lock")
    assert found[project / "specs/stable.nrs.yaml"].file == project / "reports/stable.cert.json"
