"""The map in a report: every cell has a sign, and the table shows no more than was decided."""

from fractions import Fraction

from nrs_design.certificates.certificate import Verdict
from nrs_design.pipeline.stability_map import StabilityMap
from nrs_design.reporting.sections.stability_map import stability_map_section
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE

P, Q, R = Verdict.PROVED, Verdict.INCONCLUSIVE, Verdict.REFUTED
FOUND = StabilityMap(
    0,
    (0, 1),
    (Fraction(1), Fraction(2), Fraction(3)),
    {(0, 0): P, (0, 1): P, (0, 2): R, (1, 0): Q, (1, 1): Q, (1, 2): R},
    (("soft", Fraction(40, 3), Fraction(100, 3)),),
    0,
)


def test_every_cell_has_its_sign():
    _, figure, _ = stability_map_section(read_spec(SOFT_TISSUE), FOUND).blocks
    signs = [text.get_text() for text in figure.figure.axes[0].texts]
    assert sorted(signs) == ["?", "?", "P", "P", "R", "R"]
    labels = [text.get_text() for text in figure.figure.legends[0].get_texts()]
    assert {"P: proved", "R: refuted", "?: undecided", "declared upper ends"} <= set(labels)


def test_the_table_shows_no_more_than_was_decided():
    table = stability_map_section(read_spec(SOFT_TISSUE), FOUND).blocks[2]
    assert table.columns[1:] == ("soft [N·m/rad], proved", "soft [N·m/rad], refuted")
    (_, proved, refuted), (_, none, _) = table.rows
    # What is proved is rounded inwards, what is refuted outwards.
    low, high = map(float, proved.split(" to "))
    assert 40 / 3 < low < high < 200 / 3
    low, high = map(float, refuted.split(" to "))
    assert low < 40 / 3 < 100 <= high
    assert none == "–"
