"""What combines in one spec: the table says what reading and assembling do."""

from xml.etree import ElementTree

import pytest
from making.combinations import FEATURES, Answer, pair_of, pairs, spec_of
from making.combinations_page import combinations_tables

from nrs_design.errors import AssemblyError, SpecError
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.design import run_design
from nrs_design.spec import parse_spec, read_spec

SIGNS = {Answer.TOGETHER: "", Answer.LISTED: "L", Answer.ALTERNATIVES: "/"}
NAMED = {item.name: item for item in FEATURES}


@pytest.mark.parametrize("feature", FEATURES, ids=lambda item: item.name)
def test_every_feature_is_read_alone(feature):
    assert parse_spec(spec_of(feature)) != parse_spec(spec_of())


@pytest.mark.parametrize(
    ("one", "other", "answer", "said"),
    [
        ("sampling", "contact that is lost", Answer.TOGETHER, ""),
        ("varying delay", "axes that act on each other", Answer.TOGETHER, ""),
        ("two periods", "contact that is lost", Answer.TOGETHER, ""),
        ("damped tissue", "decay although signals saturate", Answer.TOGETHER, ""),
        ("two periods", "velocity command", Answer.LISTED, ""),
        ("two periods", "axes that act on each other", Answer.LISTED, ""),
        ("two periods", "dwell times", Answer.REFUSED, "rules of switching beside"),
        ("contact that is lost", "force beside position", Answer.REFUSED, "add sampling"),
        ("axes that act on each other", "force beside position", Answer.REFUSED, "add `sampling"),
        ("velocity command", "spring Kt", Answer.REFUSED, "leave command out"),
        ("tissue that remembers", "spring Kt", Answer.REFUSED, "no rest position"),
        ("damped tissue", "tissue that remembers", Answer.ALTERNATIVES, ""),
    ],
)
def test_pairs(one, other, answer, said):
    pair = pair_of(NAMED[one], NAMED[other])
    assert pair.answer is answer
    assert said in f"{pair.why} {pair.remedy}"


@pytest.mark.slow
def test_every_pair_that_combines_makes_a_system_and_no_other(tmp_path):
    """And what is listed apart is what the proofs of one system leave out."""
    path = tmp_path / "combined.nrs.yaml"
    for pair in pairs():
        text = spec_of(*pair.features)
        names = " + ".join(item.name for item in pair.features)
        if pair.answer is Answer.ALTERNATIVES:
            continue
        path.write_text(text, encoding="utf-8")
        if pair.answer is Answer.REFUSED:
            assert pair.why, names
            assert pair.remedy, names
            try:
                loaded = read_spec(path)
            except SpecError:
                continue
            designed = run_design(loaded)
            with pytest.raises(AssemblyError):
                assemble_spec(loaded, designed, designed.spec.coordinates)
            continue
        loaded = read_spec(path)
        designed = run_design(loaded)
        system = assemble_spec(loaded, designed, designed.spec.coordinates)
        apart = system.clock is not None and bool(system.channels or system.couplings)
        assert apart is (pair.answer is Answer.LISTED), names


@pytest.mark.slow
def test_the_page_says_what_comes_of_every_pair():
    every = pairs()
    grid, _, reasons = combinations_tables(every).partition("\n\n")
    rows = [list(row)[1:] for row in ElementTree.fromstring(grid).iter("tr")][1:]
    said = dict(line.split(" | ", 1) for line in reasons.splitlines()[2:])
    names = [item.name for item in FEATURES]
    for pair in every:
        (i, one), (j, other) = ((names.index(item.name), item.name) for item in pair.features)
        sign = "".join(rows[i][j].itertext())
        assert sign == "".join(rows[j][i].itertext())
        if pair.answer is not Answer.REFUSED:
            assert sign == SIGNS[pair.answer]
            continue
        some, others, why, remedy = said[f'| <span id="refused-{sign}">{sign}</span>'].split(" | ")
        assert (why, remedy) == (pair.why, f"{pair.remedy} |")
        assert any(
            a in some.split(", ") and b in others.split(", ")
            for a, b in ((one, other), (other, one))
        )
