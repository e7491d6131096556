"""Every number and choice of a shipped spec changes something."""

import re

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import LoadedSpec, doubt_spec, parse_spec
from nrs_design.spec.document import Mapping, Scalar, Sequence, parse_document, to_data
from nrs_design.spec.edits import changed, in_one_line
from tests.support import ROOT

SHIPPED = sorted((ROOT / "specs/neuroboscope").glob("*.nrs.yaml"))
# What people read, and what only simulations do.
TEXTS = {"name", "title", "comment", "source", "notes", "identified", "scenarios"}
# Limits are what bounds, simulations and exports of force controllers are held to, and their gains
# are given as they ship.
FORCE = {"force-limit.nrs.yaml", "force-limit-offset.nrs.yaml", "force-limit-pi.nrs.yaml"}
FORCE_ALONE = {"limits.velocity", "limits.torque", "limits.bandwidth", "design.significant_digits"}
# An optimum on its lower bound does not reach the upper one.
UNREACHED = ".Mt.max"


def leaves(node, at=()):
    match node:
        case Mapping():
            for key, inner in node.entries.items():
                if key not in TEXTS:
                    yield from leaves(inner, (*at, key))
        case Sequence():
            for place, inner in enumerate(node.items):
                yield from leaves(inner, (*at, place))
        case Scalar():
            yield at, node.text


def other(text):
    """Another number, larger by a seventh, in the same unit; or another word."""
    number = re.match(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?", text)
    if number is None:
        return {"true": "false", "false": "true"}.get(text, f"{text}x")
    value = float(number[0])
    larger = value + 1 if value == int(value) and " " not in text else value * 8 / 7
    return f"{larger:.12g}{text[number.end() :]}"


def outcome(text):
    """What is designed, assembled, asked and doubted; or the refusal."""
    try:
        spec = parse_spec(text)
        designed = run_design(LoadedSpec(path="one", sha256="", text=text, spec=spec))
        system = assemble_spec(designed.loaded, designed)
        analysis = run_analysis(designed)
        doubts = [str(doubt) for doubt in (*doubt_spec(spec), *analysis.warnings)]
        achieved = [(item.name, item.achieved) for item in analysis.measured]
        return repr((designed.design, system, achieved, analysis.motion, doubts))
    except NrsDesignError as error:
        return f"refused: {error}"


def shipped(path):
    tree = parse_document(path.read_text("utf-8"))
    for at, text in leaves(tree):
        yield at, in_one_line(to_data(changed(tree, at, other(text))))


@pytest.mark.nightly
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name.partition(".")[0])
def test_every_leaf_has_an_effect(path):
    before = outcome(path.read_text("utf-8"))
    idle = {".".join(map(str, at)) for at, text in shipped(path) if outcome(text) == before}
    unreached = {place for place in idle if place.endswith(UNREACHED)}
    assert idle - unreached == (FORCE_ALONE if path.name in FORCE else set())
