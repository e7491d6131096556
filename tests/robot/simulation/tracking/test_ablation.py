import pytest

from nrs_design.robot.simulation.tracking.ablation import ablation_tracks
from nrs_design.robot.simulation.tracking.simulate import simulate
from tests.support import ROOT


@pytest.fixture(scope="module")
def changed(spec, tilted):
    return ablation_tracks(spec, tilted)


def test_same_motions_for_both_controllers(changed):
    assert len({track.experiments for _, track in changed}) == 1
    assert {one.duration for one in changed[0][1].experiments} == {20.0}


def test_one_thing_at_a_time(changed, drive):
    by_name = {(track.controller, name): track for name, track in changed}
    assert len(by_name) == len(changed) == 12
    for (controller, name), track in by_name.items():
        plain = by_name[controller, "as designed"]
        same = {
            part: getattr(track, part) is getattr(plain, part)
            for part in ("law", "drive", "encoder")
        }
        if name == "as designed":
            assert all(same.values())
        else:
            assert list(same.values()).count(False) == 1, name
    assert by_name["computed-torque", "no Coulomb friction"].drive.coulomb_friction == 0
    assert by_name["independent-joint", "encoder without counts"].encoder.counts is None
    full = by_name["computed-torque", "rotor inertia and motor damping in the law"].law
    assert (full.rotor_inertia, full.motor_damping) == (drive.inertia, drive.damping)


@pytest.mark.slow
def test_the_page_states_what_the_changes_do(changed):
    page = (ROOT / "docs/robot/motion-control.md").read_text()
    names = ("as designed", "rotor inertia in the law", "both gains times 30")
    chosen = [(name, track.only("phi")) for name, track in changed if name in names]
    for (name, track), record in zip(chosen, simulate(t for _, t in chosen), strict=True):
        (row,) = [line for line in page.splitlines() if f"{track.controller} | {name} |" in line]
        assert record.summary()["rmse"][0] == pytest.approx(float(row.split(" | ")[3]), rel=1e-2)
