"""Growth for which the environment would have to pull, wherever a verdict is told."""

import json

import pytest

import nrs_design as nrs
from nrs_design.pipeline.runs import run_certification
from nrs_design.spec import read_spec
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


def test_the_verdict_is_open_and_the_growth_is_told(spec, tmp_path):
    told = run("certify-switching", spec, "-v", "--out", "c.json", cwd=tmp_path, code=3)
    assert told.stdout.startswith(f"pulling: INCONCLUSIVE (refuted {KEPT}; ")
    assert "is not Schur (eigenvalue about 1.00054" in told.stdout
    assert f"(refuted {KEPT}; open where contact may be lost)" in told.stdout
    # The claim says that contact is kept; so how it is lost is not taken for granted beside it.
    assert "the environment pulling as it pushes" in told.stdout
    assert "Contact is lost where" not in told.stdout
    checked = run("verify", "c.json", spec, "-v", cwd=tmp_path, code=3)
    assert checked.stdout.startswith(f"INCONCLUSIVE (refuted {KEPT}) for this spec")


def test_a_gate_fails_closed(spec, tmp_path):
    gated = run("gate", spec, "--format", "json", cwd=tmp_path, code=3)
    (found,) = json.loads(gated.stdout)["specs"]
    assert (found["verdict"], found["refuted_in"]) == ("inconclusive", KEPT)
    status = {item["subject"]: item for item in found["obligations"] if item["rule"] < "NRS103"}
    assert {item["status"] for item in status.values()} == {"inconclusive"}
    assert status["system"]["message"].startswith(f"refuted {KEPT}, which decides nothing")
    assert "would have to pull" in status["withdrawal/tissue/flow-0"]["message"]


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


def test_what_asks_for_kept_contact_is_refuted(spec):
    for contact in ("contact: kept", ""):
        spec.write_text(PULLING.replace("contact: losable", contact), encoding="utf-8")
        found = run_certification(read_spec(spec)).certification
        assert (found.verdict, found.refuted_in) == ("refuted", None)
