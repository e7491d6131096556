from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import BlockTriangular
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.reporting.document import Table
from nrs_design.reporting.evidence import page_of
from nrs_design.reporting.evidence.words import all_corners
from tests.proof.graphs import common_polynomial, common_quadratic
from tests.simulation.systems import system

ONE = common_quadratic(((1,),), 0, Fraction(1, 2))
FOURTH = common_polynomial(2, ((1,),), 0, (((0,),), ((0,),)), Fraction(1, 4))
CASCADE = system([[-1, 5], [0, -2]], [[-2, -7], [0, -1]])
# The second state moves by itself and grows; the first one follows it.
GROWING = system([[-1, 5], [0, 1]], [[-2, -7], [0, -1]])
BLOCKS = ((0,), (1,))


def table(page):
    found = next(b for s in page.sections() for b in s.blocks if isinstance(b, Table))
    return {row[0]: row[1:] for row in found.rows}


def test_blocks_are_called_by_the_names_of_their_pages():
    page = page_of(CASCADE, BlockTriangular(BLOCKS, ((0, ONE), (1, FOURTH))))
    assert table(page) == {
        "1": ("x1", "common quadratic function", "0.5"),
        "2": ("x2", "common polynomial of degree 4", "0.25"),
    }


def test_blocks_that_are_not_needed_have_no_rate():
    page = page_of(GROWING, BlockTriangular(BLOCKS, ((1, staying("m0")),)))
    assert table(page) == {
        "1": ("x1", "not needed", ""),
        "2": ("x2", "a mode that is not stable", ""),
    }


def test_the_witness_of_a_block_runs_in_the_whole_family():
    unstable = staying("m0")
    page = page_of(GROWING, BlockTriangular(BLOCKS, ((1, unstable),)))
    assert page.meaning[1:] == page_of(GROWING, unstable).meaning
    assert page.limits == page_of(GROWING, unstable).limits
    assert [block.name for block in page.run().blocks] == ["run"]


@pytest.mark.parametrize(("part", "costs"), [(ONE, False), (FOURTH, True)])
def test_corners_in_discrete_time_are_as_good_as_the_worst_part(part, costs):
    discrete = replace(CASCADE, time=Time.DISCRETE, switching=Switching())
    evidence = BlockTriangular(BLOCKS, ((0, ONE), (1, part)))
    page = page_of(discrete, evidence)
    text = all_corners(discrete, evidence, page.changing)
    assert text.endswith("up to a constant factor.") is costs
    continuous = all_corners(CASCADE, evidence, page.changing)
    assert "constant factor" not in continuous
