"""One page for each kind of evidence, and nobody else asks which kind it is."""

import re

import pytest

from nrs_design.proof import evidence as proof
from nrs_design.proof.evidence import Shows
from nrs_design.reporting.document import Illustration
from nrs_design.reporting.evidence import offers, page_of
from nrs_design.reporting.evidence.words import all_corners
from tests.package import PACKAGE
from tests.proof.systems import SYSTEMS, genuine

NAMES = frozenset(proof.KINDS.values())
TEXTS = frozenset(proof.KINDS)
# What says the most, or takes long to prove, is left to the slow tests.
LONG = frozenset(
    (
        "conewise-mode-quadratic",
        "conewise-polynomial",
        "invariant-ellipsoid",
        "mode-quadratic",
        "offset-ellipsoid",
        "periodic-quadratic",
        "saturated-ellipsoid",
    )
)


def test_every_kind_has_a_row_in_the_table_of_what_it_offers():
    assert set(offers.OFFERS) == TEXTS


def test_outside_proof_and_search_only_the_table_names_a_kind():
    files = {path.relative_to(PACKAGE): path.read_text("utf-8") for path in PACKAGE.rglob("*.py")}
    for path, text in files.items():
        # Theorems for a proof assistant state the kinds again, and so does a second opinion.
        again = {"coq", "second_opinion.py"} & set(path.parts)
        if path.parts[0] in ("proof", "search") or again:
            continue
        assert not NAMES & set(re.findall(r"\w+", text)), path
        quoted = TEXTS & set(re.findall(r'"([\w-]+)"', text))
        assert not quoted or path.as_posix() == "reporting/evidence/offers.py", path


# Pages of growth differ by what shows it.
GROWING = ("mode", "average", "period", "contact", "value")
SHORT = sorted(TEXTS - LONG - {"growing-sequence", "graph"})


@pytest.mark.parametrize(
    "example",
    [
        *SHORT,
        "common-quadratic",
        "common-polynomial",
        pytest.param("mode-polynomial", marks=pytest.mark.slow),
        *(f"growing-sequence, {shape}" for shape in GROWING),
        *(pytest.param(kind, marks=pytest.mark.slow) for kind in sorted(LONG)),
    ],
)
def test_every_page_speaks_in_sentences_and_draws_a_run(example):
    example = next(name for name in SYSTEMS if name == example or name.split(",")[0] == example)
    system, evidence = genuine(example)
    page = page_of(system, evidence)
    assert page.name
    assert not page.name.endswith(".")
    sentences = (*page.meaning, all_corners(system, evidence, page.changing), *page.limits)
    assert page.meaning
    assert all(text.endswith(".") for text in sentences)
    assert all(section.blocks for section in page.sections())
    decides = evidence.shows in (Shows.STABILITY, Shows.INSTABILITY)
    assert decides == (page.run is not None)
    if page.run is not None:
        # An average has eigenvalues, and no run of its own.
        drawn = any(isinstance(block, Illustration) for block in page.run().blocks)
        assert drawn == ("average" not in page.name)


def test_the_modes_of_a_sampled_loop_are_not_said_to_be_the_corners_of_its_ranges():
    """Of the four corners of a motor's exponentials, one is left out, and one is another."""
    system, evidence = genuine("periodic-quadratic, rounding")
    said = all_corners(system, evidence, page_of(system, evidence).changing)
    assert "corners of what encloses the declared parameter ranges" in said
