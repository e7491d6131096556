"""Growth for which the environment would have to pull, wherever a verdict is told."""

import pytest

import nrs_design as nrs
from tests.simulation.interactions import WITHDRAWAL, text_of
from tests.support import document_of, run

# In kept contact it grows; with contact that may be lost, all 300 of these runs decay.
PULLING = text_of(
    {"withdrawal": WITHDRAWAL.replace("soft", "tissue")},
    {"tissue": "{model: elastic, stiffness: 58 N*m/rad}"},
    more="contact: losable\nsampling: {period: 2 ms, delay: 2}\n",
).replace("name: small", "name: pulling")
KEPT = "in kept contact"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "pulling.nrs.yaml"
    path.write_text(PULLING, encoding="utf-8")
    return path


def test_the_library_the_words_and_the_page_say_it(spec):
    decision = nrs.load(spec).certify()
    assert (decision.verdict, decision.refuted_in) == ("inconclusive", KEPT)
    assert not decision
    assert decision.claim.startswith(f"Refuted {KEPT}")
    assert decision.result.certificate.refuted_in == KEPT
    page = decision.report()
    assert f"Refuted {KEPT}, where the environment would have to pull" in page
    explained = run("explain", "inconclusive", cwd=spec.parent).stdout
    assert "refuted in kept contact" in " ".join(explained.split())


@pytest.mark.slow
def test_margins_say_on_what_they_rest(spec, tmp_path):
    summary = document_of("certify-switching", spec, "--margin", cwd=tmp_path)
    assert summary["refuted_in"] == KEPT
    delay, period = (summary["loop_margins"][name] for name in ("delay", "period"))
    assert (delay["refuted"], delay["refuted_in"], period["refuted_in"]) == (2, KEPT, KEPT)
