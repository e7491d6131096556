"""``nrs-design optimize --retune``, as a user types it."""

from fractions import Fraction

from nrs_design.cli.retuned_gains import RetunedBox
from nrs_design.pipeline.retuned_gains import RetunedGains
from tests.support import SOFT_TISSUE, document_of, run


def test_the_box_is_written_with_its_certificate(tmp_path):
    document = document_of(
        "optimize", "--retune", "--out", "wider.nrs.yaml", SOFT_TISSUE, cwd=tmp_path
    )
    retuned = document["retuned"]
    assert retuned["share"] >= 0.09
    low, high = retuned["Bt"]["withdrawal"]
    assert low < 1.04 < high
    verified = run("verify", retuned["certificate"], retuned["spec"], cwd=tmp_path)
    assert verified.returncode == 0
    assert "Bt anywhere in" in verified.stdout


def test_without_a_box_it_says_so(capsys):
    box = RetunedBox(RetunedGains(Fraction(0), 1, {}, None), None, None)
    box.show()
    assert "Bt may not be retuned" in capsys.readouterr().out
    assert box.facts()["share"] == 0
    assert box.facts()["not_proved_at"] == 0.01
