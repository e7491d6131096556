"""A staircase of nested cells is found with few decisions, and nothing is claimed beyond them."""

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.staircase import decide_staircase

P, Q, R = Verdict.PROVED, Verdict.INCONCLUSIVE, Verdict.REFUTED
ROWS, COLUMNS = 5, 9


@st.composite
def stairs(draw):
    """Return ends of what is proved and where what is refuted begins, in each row."""
    proved = sorted(draw(st.lists(st.integers(0, COLUMNS), min_size=ROWS, max_size=ROWS)))[::-1]
    gaps = draw(st.lists(st.integers(0, 3), min_size=ROWS, max_size=ROWS))
    begins = [min(p + gap, COLUMNS) for p, gap in zip(proved, gaps, strict=True)]
    return proved, [min(begins[: row + 1]) for row in range(ROWS)]


@given(stairs())
def test_a_staircase_is_found(ends):
    proved, refuted = ends
    # What a longer age refutes from, it refutes from there on; what is proved is never refuted.
    refuted = [max(r, max(proved[row:])) for row, r in enumerate(refuted)]
    asked = []

    def decide(cell):
        asked.append(cell)
        row, column = cell
        return P if column < proved[row] else R if column >= refuted[row] else Q

    found = decide_staircase(ROWS, COLUMNS, decide)
    assert found == {(r, c): decide((r, c)) for r in range(ROWS) for c in range(COLUMNS)}
    searched = asked[: -ROWS * COLUMNS]
    assert len(searched) == len(set(searched)) <= 2 * 4 * ROWS


def test_what_no_search_decides_is_inconclusive():
    assert set(decide_staircase(2, 3, lambda _: Q).values()) == {Q}


def test_one_refutation_settles_all_that_allows_more():
    asked = []

    def decide(cell):
        asked.append(cell)
        return R

    assert set(decide_staircase(3, 4, decide).values()) == {R}
    assert all(row == 0 for row, _ in asked)
