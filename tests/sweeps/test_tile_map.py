"""Every tile as its own spec says; proofs are for boxes, and refutations have witnesses."""

from itertools import pairwise, product

import pytest

from nrs_design.certificates.certificate import Verdict, dump
from nrs_design.certificates.verify import verify
from nrs_design.pipeline import run_design
from nrs_design.pipeline.written_gains import with_own_gains
from nrs_design.spec import read_spec
from nrs_design.sweeps.tile_map import run_tile_map
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


def test_every_certificate_is_about_the_spec_of_its_box(tmp_path):
    found = mapped("environments.soft.stiffness=300..1100/4 N/m", path=SAMPLED)
    covered = set()
    for certificate, box in zip(found.certificates, found.boxes, strict=True):
        (tmp_path / "a.nrs.yaml").write_text(found.grid.text_of(box), encoding="utf-8")
        (tmp_path / "a.cert.json").write_text(dump(certificate, "a.nrs.yaml"), encoding="utf-8")
        checked = verify(tmp_path / "a.cert.json", read_spec(tmp_path / "a.nrs.yaml"))
        assert checked.fault is None
        if checked.certificate.verdict == Verdict.PROVED:
            covered |= set(product(*(range(first, last + 1) for first, last in box)))
    proved = {place for place, tile in found.tiles.items() if tile.verdict is Verdict.PROVED}
    assert proved == covered != set()


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
    found = mapped("sampling.period=1,2 ms", "sampling.delay=0..1", path=SAMPLED)
    assert all(tile.verdict is not None for tile in found.tiles.values())


@pytest.mark.parametrize("field", ["environments.soft.lever_arm=0.2,0.24 m"])
def test_a_witness_is_none_of_a_proof(field):
    found = mapped(field, path=SOFT_TISSUE)
    assert {str(tile.verdict) for tile in found.tiles.values()} <= {"proved", "refuted"}
    assert found.witnesses == 0
