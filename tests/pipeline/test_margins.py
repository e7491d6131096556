"""How far a proof reaches: what is said meanwhile, what is refused, delays of one mode alone."""

from dataclasses import replace
from pathlib import Path

import pytest

from nrs_design.errors import DesignError
from nrs_design.pipeline import run_certification
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.design import run_design
from nrs_design.pipeline.margins import check_margins, run_margin
from nrs_design.search.certify import is_refuted_at_once
from nrs_design.spec import read_spec
from tests.support import COMMUTING, SOFT_TISSUE

LINE = """\
kind: switched-system
name: line
time: continuous
parameters:
  p: {nominal: 1, range: [0, 2]}
modes:
  - {name: line, A: [[-3 + p]]}
switching: arbitrary
"""
EXAMPLE = Path("docs/examples/everything-at-once.nrs.yaml")


def late(loaded, designed, delay):
    """Return the loop where every force sample is so old."""
    sampling = designed.spec.sampling.model_copy(update={"delay": (delay, delay)})
    spec = designed.spec.model_copy(update={"sampling": sampling, "disturbances": None})
    return assemble_spec(loaded, replace(designed, spec=spec), designed.spec.coordinates)


def test_axes_that_act_on_each_other_are_refuted_beyond_what_a_spec_can_declare():
    """18 samples of 2 ms are borne by every mode alone, 19 are not."""
    loaded = read_spec(EXAMPLE)
    designed = run_design(loaded)
    assert not is_refuted_at_once(late(loaded, designed, 18))
    assert is_refuted_at_once(late(loaded, designed, 19))


@pytest.mark.parametrize(("delay", "expected"), [(0, False), (3, True)])
def test_two_periods_are_refuted_by_a_round(tmp_path, delay, expected):
    """No mode of theirs is stable by itself, as the command is held: rounds decide."""
    path = tmp_path / "round.nrs.yaml"
    sampling = "sampling: {period: 2 ms, outer_period: 10 ms, delay: 0}\n"
    path.write_text(SOFT_TISSUE.read_text(encoding="utf-8") + sampling, encoding="utf-8")
    loaded = read_spec(path)
    assert is_refuted_at_once(late(loaded, run_design(loaded), delay)) is expected


def test_what_is_known_is_said_while_the_search_goes_on(tmp_path):
    """``x' = (p - 3) x`` with p within 1 of 1: proved below a scale of 2, refuted from there on."""
    path = tmp_path / "line.nrs.yaml"
    path.write_text(LINE, encoding="utf-8")
    told: list[str] = []
    found = run_margin(run_certification(read_spec(path)), progress=told.append)
    assert told[0] == "box scaled by 2 (proved: 1)"
    assert told[1] == "box scaled by 1.5 (proved: 1, refuted: 2)"
    assert found.proved is not None
    assert 1.9 < found.proved < 2
    assert told[-1].endswith("(proved: about 1.99988, refuted: 2)")


def test_what_a_margin_would_be_about_is_missing():
    result = run_certification(read_spec(COMMUTING))
    with pytest.raises(DesignError, match="declares no range"):
        check_margins(result, margin=True, shortest_dwell=False)
    check_margins(result, margin=False, shortest_dwell=True)
