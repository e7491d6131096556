"""Delays that are refuted by one mode alone, beyond those that are decided."""

from dataclasses import replace
from pathlib import Path

import pytest

from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.design import run_design
from nrs_design.search.certify import is_refuted_at_once
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE

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
