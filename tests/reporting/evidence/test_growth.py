from nrs_design.reporting.document import Paragraph
from nrs_design.reporting.evidence import page_of
from tests.proof.systems import genuine

SYSTEM, EVIDENCE = genuine("growing-sequence, value")


def test_it_is_the_page_of_its_part_at_one_value():
    page = page_of(SYSTEM, EVIDENCE)
    part = page_of(*EVIDENCE.at_value(SYSTEM))
    assert page.meaning[1:] == part.meaning
    assert page.limits[:-1] == part.limits
    assert "a narrower range may be stable" in page.limits[-1]
    first, *rest = page.run().blocks
    assert isinstance(first, Paragraph)
    assert "Simulated at the value of the parameter" in first.text
    assert [block.title for block in rest] == [block.title for block in part.run().blocks]
