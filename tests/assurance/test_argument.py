"""Every argument keeps the rules of the notation, and says what is open."""

import json

import pytest

from nrs_design.assurance.gsn import IN_CONTEXT, MAY_SUPPORT, GsnKind


def argument_of(folder):
    facts = json.loads((folder / "evidence.json").read_text())
    return {element["id"]: element for element in facts["argument"]}, facts


@pytest.mark.parametrize(
    "folder", ["matrices_folder", pytest.param("sampled_folder", marks=pytest.mark.slow)]
)
def test_it_is_a_tree_that_keeps_the_rules(request, folder):
    elements, facts = argument_of(request.getfixturevalue(folder))
    assert len(elements) == len(facts["argument"])
    children = [c for e in elements.values() for c in (*e["supported_by"], *e["in_context_of"])]
    assert sorted(children) == sorted(elements.keys() - {"G1"})
    for element in elements.values():
        kind = GsnKind(element["kind"])
        support = {elements[id]["kind"] for id in element["supported_by"]}
        assert support <= set(MAY_SUPPORT.get(kind, ()))
        assert {elements[id]["kind"] for id in element["in_context_of"]} <= set(IN_CONTEXT)
        assert element["undeveloped"] == (kind in MAY_SUPPORT and not support)


@pytest.mark.slow
def test_every_assumption_and_every_hazard_is_in_it(sampled_folder):
    elements, facts = argument_of(sampled_folder)
    texts = [element["text"] for element in elements.values() if element["kind"] == "goal"]
    for part in ("assumptions", "hazards"):
        for row in facts[part]:
            assert sum(text.startswith(f"{row['id']}: ") for text in texts) == 1
    assert any(facts["claim"] in element["text"] for element in elements.values())


@pytest.mark.slow
def test_what_is_open_is_undeveloped(sampled_folder):
    elements, facts = argument_of(sampled_folder)
    undeveloped = {e["text"].partition(":")[0] for e in elements.values() if e["undeveloped"]}
    assert set(facts["open"]) <= undeveloped
    settled = {row["id"] for row in facts["assumptions"]} - set(facts["open"])
    assert settled == {"any-signal.all"}
    assert not settled & undeveloped


def test_without_a_program_the_argument_says_why(matrices_folder):
    elements, _ = argument_of(matrices_folder)
    assert elements["G4"]["undeveloped"]
    assert "no program here: the spec gives matrices, and no law" in elements["G4"]["text"]
