"""Every tile as its own spec says; proofs are for boxes, and refutations have witnesses."""

from itertools import pairwise, product

import pytest

from nrs_design.certificates.certificate import Verdict, dump
from nrs_design.certificates.verify import verify
from nrs_design.pipeline import run_design
from nrs_design.pipeline.written_gains import with_own_gains
from nrs_design.spec import read_spec
from nrs_design.sweeps.paint import run_tile_map
from nrs_design.sweeps.refine import refined
from nrs_design.sweeps.tiles import read_tiles
from tests.support import ROOT, SOFT_TISSUE

SAMPLED = ROOT / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"
OSCILLATOR = """
kind: switched-system
name: oscillator
time: continuous
parameters:
  k: {nominal: 2, range: [1, 3]}
modes:
  - {name: a, A: [[0, 1], [-k, -1]]}
  - {name: b, A: [[0, 1], [-2, -1]]}
switching: arbitrary
"""


def mapped(*said, path):
    loaded = read_spec(path)
    designed = run_design(loaded)
    given = loaded if designed is None else with_own_gains(designed)
    return run_tile_map(read_tiles(given, path, list(said)), designed)


def signs(found):
    shape = found.grid.shape
    return [
        "".join(found.tiles[k, level].shown[0] for k in range(shape[0]))
        for level in range(shape[1])
    ]


def test_stiffness_over_age():
    """What is proved is proved for younger samples, and what grows does with older ones."""
    found = mapped(
        "environments.soft.stiffness=300..1100/4 N/m", "sampling.delay=0..2", path=SAMPLED
    )
    rows = signs(found)
    assert rows[0][0] == "p"
    assert rows[2][-2:] == "rr"
    for lower, upper in pairwise(rows):
        assert all(a == "p" for a, b in zip(lower, upper, strict=True) if b == "p")
        assert all(b == "r" for a, b in zip(lower, upper, strict=True) if a == "r")
    assert len(found.certificates) < len(found.tiles)


def boxes_of(found, folder):
    """Verify every certificate against the spec of its box, and return the tiles of the proofs."""
    covered = set()
    for certificate, box in zip(found.certificates, found.boxes, strict=True):
        (folder / "a.nrs.yaml").write_text(found.grid.text_of(box), encoding="utf-8")
        (folder / "a.cert.json").write_text(dump(certificate, "a.nrs.yaml"), encoding="utf-8")
        checked = verify(folder / "a.cert.json", read_spec(folder / "a.nrs.yaml"))
        assert checked.fault is None
        if checked.certificate.verdict == Verdict.PROVED:
            covered |= set(product(*(range(first, last + 1) for first, last in box)))
    return covered


def proved_in(found):
    return {place for place, tile in found.tiles.items() if tile.verdict is Verdict.PROVED}


def test_every_certificate_is_about_the_spec_of_its_box(tmp_path):
    found = mapped("environments.soft.stiffness=300..1100/4 N/m", path=SAMPLED)
    assert proved_in(found) == boxes_of(found, tmp_path) == {(0,), (1,)}


def test_borders_are_refined(tmp_path):
    """What is not proved beside what is: halved, with certificates about the finer boxes."""
    coarse = mapped("environments.soft.stiffness=500,700,900,1100 N/m", path=SAMPLED)
    assert [tile.shown[0] for tile in coarse.tiles.values()] == ["p", "r", "r"]
    fine = refined(coarse, run_design(read_spec(SAMPLED)), 1)
    assert fine.grid.fields[0].values == (500, 700, 800, 900, 1100)
    assert [tile.shown[0] for tile in fine.tiles.values()] == ["p", "p", "r", "r"]
    assert proved_in(fine) == boxes_of(fine, tmp_path) == {(0,), (1,)}
    # A form is carried to what is beside it before another one is looked for.
    assert fine.carried > 0
    assert refined(fine, None, 0) is fine


def test_what_is_proved_stays_so_on_a_finer_grid(tmp_path):
    path = tmp_path / "oscillator.nrs.yaml"
    path.write_text(OSCILLATOR, encoding="utf-8")
    coarse = mapped("parameters.k=1,3,9", path=path)
    assert coarse.tiles[0,].shown == "proved"
    fine = refined(coarse, None, 1)
    assert fine.grid.fields[0].values == (1, 3, 6, 9)
    assert (0,) in proved_in(fine)
    assert proved_in(fine) == boxes_of(fine, tmp_path)


def test_a_map_without_a_border_is_as_fine_as_it_gets():
    found = mapped("environments.soft.lever_arm=0.2,0.24 m", path=SOFT_TISSUE)
    assert refined(found, run_design(read_spec(SOFT_TISSUE)), 3) is found


@pytest.mark.nightly
def test_programs_of_a_large_map():
    """176 tiles, with ages up to 10, of at most 15 programs."""
    found = mapped(
        "environments.soft.stiffness=17..4340/16 N/m", "sampling.delay=0..10", path=SAMPLED
    )
    assert found.proofs <= 15
    assert found.counts()["proved"] == 5
    assert found.counts()["refuted in kept contact"] == 154


def test_a_box_has_the_gains_of_the_spec(tmp_path):
    """They are given in the text that a certificate is written with, whatever its stiffness."""
    loaded = read_spec(SAMPLED)
    designed = run_design(loaded)
    path = tmp_path / "a.nrs.yaml"
    given = with_own_gains(designed)
    path.write_text(given.text, encoding="utf-8")
    grid = read_tiles(read_spec(path), path, ["environments.soft.stiffness=60..80/2 N/m"])
    box = ((0, 1),)
    path.write_text(grid.text_of(box), encoding="utf-8")
    assert run_design(read_spec(path)).design == designed.design


def test_given_matrices(tmp_path):
    path = tmp_path / "a.nrs.yaml"
    path.write_text(OSCILLATOR, encoding="utf-8")
    found = mapped("parameters.k=1..9/8", path=path)
    verdicts = [str(tile.verdict) for tile in found.tiles.values()]
    assert verdicts[:4] == ["proved"] * 4
    # Zelentsovsky 1994: from 2 on, it is stable up to 8.98513.
    assert verdicts[-1] == "refuted"
    assert "refuted" not in verdicts[:-1]


def test_values_that_make_no_spec(tmp_path):
    """A delay below the shortest one is no range; the levels above it are decided all the same."""
    path = tmp_path / "a.nrs.yaml"
    text = SAMPLED.read_text(encoding="utf-8").replace("delay: [0, 1]", "delay: [1, 1]")
    path.write_text(text, encoding="utf-8")
    found = mapped("environments.soft.stiffness=300,400,2000 N/m", "sampling.delay=0..1", path=path)
    wrong = {place: tile.wrong for place, tile in found.tiles.items()}
    assert "delay" in wrong[0, 0]
    assert "delay" in wrong[1, 0]
    assert wrong[0, 1] == wrong[1, 1] == ""
    assert [found.tiles[k, 1].shown for k in (0, 1)] == ["proved", "refuted in kept contact"]


@pytest.mark.parametrize("field", ["environments.soft.lever_arm=0.2,0.24 m"])
def test_what_is_proved_is_asked_once(field):
    """A look for modes that grow, and a program each."""
    found = mapped(field, path=SOFT_TISSUE)
    assert {str(tile.verdict) for tile in found.tiles.values()} == {"proved"}
    assert (found.proofs, found.witnesses) == (2, 2)
