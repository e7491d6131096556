"""Evidence of kind block-triangular: the order of blocks, what the parts must show, attacks."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import BlockTriangular, read_evidence
from nrs_design.proof.evidence.block_triangular import diagonal_block
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.mode import Time
from tests.proof.graphs import common_polynomial, common_quadratic, mode_quadratic
from tests.proof.systems import family, genuine
from tests.support import ends_soon

ONE = common_quadratic(((1,),), 0, Fraction(1, 2))
CASCADE = family([[-1, 5], [0, -2]], [[-2, -7], [0, -1]])


def test_the_rate_is_that_of_the_slowest_block():
    slow = replace(ONE, rate=Fraction(1, 8))
    evidence = BlockTriangular(((0,), (1,)), ((0, ONE), (1, slow)))
    assert evidence.proved_rate(CASCADE) == Fraction(1, 8)
    steps = family([["1/8", 5], [0, "1/4"]], time=Time.DISCRETE)
    fast = BlockTriangular(((0,), (1,)), ((0, replace(ONE, rate=Fraction(1, 4))), (1, ONE)))
    assert fast.proved_rate(steps) == Fraction(1, 2)


def test_the_claim_names_blocks_and_states():
    evidence = BlockTriangular(((0,), (1,)), ((0, ONE), (1, ONE)))
    one = ONE.claim(family([[-1]], [[-1]]))
    assert evidence.claim(CASCADE) == (
        "In a common order of the states all modes are block triangular with 2 diagonal blocks. "
        f"Block 1 (x1): {one} Block 2 (x2): {one} Together: every solution decays exponentially, "
        "at any rate slower than the slowest of these."
    )


@pytest.mark.parametrize(
    "change",
    [
        {"blocks": [[0] * 10**5, [1]]},
        {"blocks": [[], [0, 1]]},
        {"blocks": []},
        {"blocks": [[0], [7]]},
        {"parts": []},
        {"parts": [{"block": -1, "kind": "common-quadratic"}]},
        {"parts": [{"block": 2, "kind": "common-quadratic"}]},
        {"parts": [{"block": 0, "kind": "block-triangular", "blocks": [[0]], "parts": []}]},
    ],
)
def test_hostile_fields_are_rejected_at_once(change):
    fields = {
        "kind": "block-triangular",
        **BlockTriangular(((0,), (1,)), ((0, ONE), (1, ONE))).to_fields(),
    }
    with ends_soon(), pytest.raises(ValueError, match=r"part|nothing"):
        read_evidence({**fields, **change}, CASCADE)


def test_the_diagonal_block_of_a_family():
    block = diagonal_block(CASCADE, (1,))
    assert [mode.A.fractions() for mode in block.modes] == [[[-2]], [[-1]]]
    assert block.states == ("x2",)


def test_no_rate_follows_from_a_part_without_one():
    system = family([[1, 0], [0, -1]])
    evidence = BlockTriangular(((0,), (1,)), ((0, staying("m0")),))
    assert evidence.find_fault(system) is None
    assert evidence.proved_rate(system) is None


def test_blocks_say_of_themselves_what_their_parts_do():
    one, slow = common_quadratic(((1,),), 0, Fraction(1)), staying("m0")
    form = common_polynomial(2, ((1,),), 0, (((0,),),), Fraction(1))
    quadratic = BlockTriangular(((0,), (1,)), ((0, one), (1, one)))
    mixed = BlockTriangular(((0,), (1,)), ((0, one), (1, form)))
    unstable = BlockTriangular(((0,), (1,)), ((1, slow),))
    assert [b.is_common_quadratic for b in (quadratic, mixed, unstable)] == [True, False, False]
    assert [b.keeps_bound_in_mixtures for b in (quadratic, mixed)] == [True, False]
    assert [b.names_unstable_mode for b in (quadratic, mixed, unstable)] == [False, False, True]
    assert BlockTriangular(((0,), (1,)), ((0, one), (1, slow))).names_unstable_mode


def test_both_blocks_survive_a_file():
    evidence = BlockTriangular(((0,), (1,)), ((0, ONE), (1, ONE)))
    fields = {"kind": "block-triangular", **evidence.to_fields()}
    assert read_evidence(fields, CASCADE) == evidence
    # One that would be read in its block, if it were not in blocks itself.
    inner = BlockTriangular(((0,),), ((0, ONE),))
    for parts in (((0, inner), (1, ONE)), ((0, ONE), (1, inner))):
        nested = {"kind": "block-triangular", **replace(evidence, parts=parts).to_fields()}
        with pytest.raises(ValueError, match="a part is itself in blocks"):
            read_evidence(nested, CASCADE)


def test_parts_are_spread_over_equal_modes():
    system, evidence = genuine("block-triangular")
    again = tuple(replace(mode, name=f"{mode.name} again") for mode in system.modes)
    twice = replace(system, modes=(*system.modes, *again))
    spread = evidence.spread(system, twice)
    assert [index for index, _ in spread.parts] == [index for index, _ in evidence.parts]
    assert spread.find_fault(twice) is None
    assert evidence.find_fault(twice) is not None


def test_averages_are_covered_where_every_block_covers_them():
    each = mode_quadratic((("m0", ((1,),)), ("m1", ((1,),))), 0, Fraction(1, 2))
    for part, covered in ((ONE, True), (each, False)):
        evidence = BlockTriangular(((0,), (1,)), ((0, ONE), (1, part)))
        assert evidence.find_fault(CASCADE) is None
        assert evidence.covers_mixtures is covered
