"""Equal modes and triangular blocks."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.channels import Rounding
from nrs_design.proof.evidence.block_triangular import is_block_triangular, is_partition
from nrs_design.proof.mode import Time
from nrs_design.search.structure import merge_equal_modes, triangular_blocks
from tests.proof.systems import dayawansa_martin, degenerate_dual, family, matrix

PATTERNS = st.integers(1, 5).flatmap(
    lambda n: st.lists(
        st.lists(st.lists(st.sampled_from([0, 0, 0, 1]), min_size=n, max_size=n), min_size=n,
                 max_size=n),
        min_size=1,
        max_size=3,
    )
)  # fmt: skip


@given(PATTERNS)
def test_blocks_partition_the_states_and_are_triangular(matrices):
    system = family(*matrices)
    blocks = triangular_blocks(system)
    assert is_partition(blocks, system.order)
    assert is_block_triangular(system, blocks)


@given(PATTERNS)
def test_no_block_can_be_split(matrices):
    # In a strongly connected block every state drives every other, perhaps by way of others.
    n = len(matrices[0])
    drives = [[any(A[i][j] for A in matrices) or i == j for j in range(n)] for i in range(n)]
    for k in range(n):
        for i in range(n):
            for j in range(n):
                drives[i][j] |= drives[i][k] and drives[k][j]
    for block in triangular_blocks(family(*matrices)):
        assert all(drives[i][j] for i in block for j in block)


def test_known_structure():
    assert len(triangular_blocks(degenerate_dual())) == 2
    assert triangular_blocks(dayawansa_martin(6)) == ((0, 1),)
    assert triangular_blocks(family([[-1, 1], [0, -1]])) == ((0,), (1,))
    assert triangular_blocks(family([[-1, 0], [1, -1]])) == ((1,), (0,))


def test_the_first_of_equal_modes_stays():
    A, B = [[-1, 0], [0, -2]], [[-2, 1], [0, -1]]
    merged = merge_equal_modes(family(A, B, A, [["-1.0", 0], [0, "-4/2"]]))
    assert [mode.name for mode in merged.modes] == ["m0", "m1"]


def test_equal_modes_that_round_unlike_are_not_merged():
    """What the arithmetic adds may differ between them."""
    A = [["1/2", 0], [0, "1/4"]]
    columns, rows = (matrix([[1], [0]]),) * 2, (matrix([[1, 0]]), matrix([[2, 0]]))
    system = family(A, A, time=Time.DISCRETE)
    assert len(merge_equal_modes(system).modes) == 1
    rounded = replace(system, roundings=(Rounding("r", columns, rows),))
    assert merge_equal_modes(rounded) == rounded
