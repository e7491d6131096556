"""How far a proof reaches: what is said meanwhile, what is refused, delays of one mode alone."""

from dataclasses import replace
from pathlib import Path

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.pipeline import margins
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.margins import run_proof_margins
from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.search.certification import Limits
from nrs_design.search.certify import refuted_at_once
from nrs_design.spec import read_spec
from tests.support import COMMUTING, SOFT_TISSUE, spec_in
from tests.tables import spec_text

LINE = spec_text("line")
SAMPLED = spec_text("one-late-controller")
EXAMPLE = Path("docs/examples/everything-at-once.nrs.yaml")


def late(loaded, designed, delay):
    """Return the loop where every force sample is so old."""
    sampling = designed.spec.sampling.model_copy(update={"delay": (delay, delay)})
    spec = designed.spec.model_copy(update={"sampling": sampling, "disturbances": None})
    return assemble_spec(loaded, replace(designed, spec=spec))


def test_a_delay_is_refuted_beyond_what_a_spec_can_declare():
    """20 samples of 2 ms are borne by every mode alone, 21 are not."""
    loaded = read_spec(EXAMPLE)
    designed = run_design(loaded)
    assert refuted_at_once(late(loaded, designed, 20)) is None
    assert refuted_at_once(late(loaded, designed, 21)) == "in kept contact"


@pytest.mark.parametrize(("delay", "expected"), [(0, False), (3, True)])
def test_two_periods_are_refuted_by_a_round(tmp_path, delay, expected):
    """No mode of theirs is stable by itself, as the command is held: rounds decide."""
    sampling = "sampling: {period: 2 ms, outer_period: 10 ms, delay: 0}\n"
    path = spec_in(tmp_path, SOFT_TISSUE.read_text(encoding="utf-8") + sampling, "round")
    loaded = read_spec(path)
    assert (refuted_at_once(late(loaded, run_design(loaded), delay)) is not None) is expected


def test_what_is_known_is_said_while_the_search_goes_on(tmp_path):
    """``x' = (p - 3) x`` with p within 1 of 1: proved below a scale of 2, refuted from there on."""
    path = spec_in(tmp_path, LINE, "line")
    told: list[str] = []
    result = run_certification(read_spec(path))
    found = run_proof_margins(result, Limits(), told.append, margin=True, shortest_dwell=False).box
    assert told[0] == "box scaled by 2 (proved: 1)"
    assert told[1] == "box scaled by 1.5 (proved: 1, refuted: 2)"
    assert found.proved is not None
    assert 1.9 < found.proved < 2
    assert told[-1].endswith("(proved: about 1.99988, refuted: 2)")


def test_what_a_margin_would_be_about_is_missing():
    """It is refused before anything is searched for."""
    result, told = run_certification(read_spec(COMMUTING)), []
    with pytest.raises(DesignError, match="declares no range") as caught:
        run_proof_margins(result, Limits(), told.append, margin=True, shortest_dwell=True)
    assert (caught.value.path, told) == (COMMUTING, [])
    assert caught.value.remedy
    found = run_proof_margins(result, Limits(), told.append, margin=False, shortest_dwell=True)
    assert (found.loop, found.box, found.dwell.proved) == (None, None, 0)


def test_a_delay_that_makes_no_loop_ends_the_search_and_says_why(tmp_path, monkeypatch):
    """As a period does: what is proved below it is told."""
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    path = spec_in(tmp_path, text[: text.index("environments:")] + SAMPLED, "late")
    result = run_certification(read_spec(path), limits=Limits(max_degree=2, optimize_rate=False))
    assert result.certification.verdict is Verdict.PROVED

    def refuse(*given):
        raise AssemblyError("the loop is too large")

    monkeypatch.setattr(margins, "assemble_spec", refuse)
    loop = run_proof_margins(result, Limits(), margin=True, shortest_dwell=False).loop
    assert (loop.delay.proved, loop.delay.refuted) == (1, None)
    assert "what is beyond makes no system (the loop is too large)" in loop.delay.end
    assert "what is beyond makes no system (the loop is too large)" in loop.period.end
