"""``nrs-design optimize --retune``, as a user types it."""

from fractions import Fraction

from nrs_design.cli.retuned_gains import RetunedBox
from nrs_design.pipeline import run_interaction
from nrs_design.pipeline.retuned_gains import RetunedGains, run_retuned_gains
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE, document_of, run


def test_the_box_is_written_with_its_certificate(tmp_path):
    document = document_of(
        "optimize", "--retune", "--out", "wider.nrs.yaml", SOFT_TISSUE, cwd=tmp_path
    )
    retuned = document["retuned"]
    assert retuned["share"] >= 0.09
    low, high = retuned["Bt"]["withdrawal"]
    assert low < 1.04 < high
    verified = run("verify", "-v", retuned["certificate"], retuned["spec"], cwd=tmp_path)
    assert verified.returncode == 0
    assert "Bt anywhere in" in verified.stdout


def test_a_proof_says_how_much_it_takes_for_granted(capsys):
    """A box is proved of a controller that keeps its velocity: that must be within reach."""
    box = run_retuned_gains(run_interaction(read_spec(SOFT_TISSUE), "has nothing to design"))
    RetunedBox(box, None, None).show()
    granted = len(box.result.certification.granted)
    assert f"takes {granted} things for granted (-v)" in capsys.readouterr().out


def test_without_a_box_it_says_so(capsys):
    box = RetunedBox(RetunedGains(Fraction(0), 1, {}, None, goals=True), None, None)
    box.show()
    said = capsys.readouterr().out
    assert "Bt may not be retuned" in said
    assert "with the goals of the proof" in said
    assert box.facts()["share"] == 0
    assert box.facts()["not_proved_at"] == 0.01


def test_nothing_proved_is_inconclusive(tmp_path):
    path = tmp_path / "wide.nrs.yaml"
    path.write_text(SOFT_TISSUE.read_text().replace("768.17 N/m", "1300 N/m"))
    done = run("optimize", "--retune", "--out", "new.nrs.yaml", path, cwd=tmp_path, code=3)
    assert "within ±1 % of all controllers, not proved" in done.stdout
    assert not (tmp_path / "new.nrs.yaml").exists()
