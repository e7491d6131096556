"""Every row of the table of what is not modelled together refuses a spec that has its features."""

import json
import re
from itertools import combinations
from pathlib import Path
from string import Formatter

import pytest

from nrs_design.errors import AssemblyError, SpecError
from nrs_design.models.axis import AxisType
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import doubt_spec, parse_spec, read_spec
from nrs_design.spec import features as f
from nrs_design.spec.check import Row
from nrs_design.spec.combinations import CHANGING, COMBINATIONS
from nrs_design.spec.interaction_doubts import INTERACTION_DOUBTS
from nrs_design.spec.load import SPEC_KINDS, model_of
from nrs_design.spec.model import SpecModel
from tests.tables import table

CREEPING = {
    "model": "kelvin-boltzmann",
    "parallel_stiffness": "30 N*m/rad",
    "series_stiffness": "25 N*m/rad",
    "damping": "3 N*m*s/rad",
}
# What a spec must say to have a feature, merged into the plainest one, in this order.
FEATURES = table(Path(__file__).with_name("features.yaml"))
BASE = FEATURES["BASE"]
CHANGES = {getattr(f, name): changes for name, changes in FEATURES.items() if name != "BASE"}


def merged(tree, changes):
    """The text of a spec; a part that says its type or model takes the place of another."""
    if not (isinstance(tree, dict) and isinstance(changes, dict)) or "type" in changes:
        return changes
    kept = {key: value for key, value in tree.items() if changes.get(key, "") is not None}
    given = {key: value for key, value in changes.items() if value is not None}
    return kept | {key: merged(tree.get(key), value) for key, value in given.items()}


def slid(value):
    """The same numbers of an axis that slides."""
    if isinstance(value, dict):
        return {key: slid(item) for key, item in value.items()}
    if isinstance(value, list):
        return [slid(item) for item in value]
    number, _, unit = str(value).partition(" ")
    turning = unit.startswith(("N*m", "rad", "deg", "kg*m", "rpm*s"))
    return f"{number} {AxisType.PRISMATIC.unit(unit)}" if turning else value


def spec_with(*features):
    tree = BASE
    for feature, changes in CHANGES.items():
        if feature in features:
            tree = merged(tree, changes)
    return json.dumps(slid(tree) if f.SLIDING in features else tree, indent=1)


def test_every_feature_has_its_change():
    named = {v for v in vars(f).values() if isinstance(v, type(f.SAMPLED))}
    used = {item for row in (*COMBINATIONS, *INTERACTION_DOUBTS) for item in row.features}
    assert named == set(CHANGES) == used


@pytest.mark.parametrize("row", COMBINATIONS, ids=lambda row: row.message)
def test_what_is_not_modelled_together_is_refused(row):
    """With the words of the row, at a line of the file, and with something to do."""
    with pytest.raises(SpecError) as caught:
        parse_spec(spec_with(*row.features))
    pattern = re.sub(r"\\\{.*?\}", ".+", re.escape(row.message))
    said = [fault for fault in caught.value.faults if re.search(pattern, fault.message)]
    assert said
    for fault in said:
        assert fault.line > 1
        assert fault.remedy
        assert "{" not in fault.message


@pytest.mark.parametrize("features", CHANGING, ids=lambda items: items[0].phrase)
def test_no_dwell_time_is_searched_where_something_may_change(features):
    assert parse_spec(spec_with()).find_dwell_obstacle() is None
    said = json.loads(spec_with(*features))
    if f.MEMORY in features:
        # One that has a place of rest, beside what is given positions.
        said["environments"]["soft"] = CREEPING
    found = parse_spec(json.dumps(said)).find_dwell_obstacle()
    assert "a dwell time beside" in found.message
    assert found.remedy


@pytest.mark.slow
def test_every_pair_that_is_read_makes_a_system_or_is_warned_of(tmp_path):
    path = tmp_path / "combined.nrs.yaml"
    made = 0
    for pair in combinations(CHANGES, 2):
        path.write_text(spec_with(*pair), encoding="utf-8")
        try:
            loaded = read_spec(path)
        except SpecError:
            continue
        doubts = " ".join(doubt.message for doubt in doubt_spec(loaded.spec))
        designed = run_design(loaded)
        if "certify-switching refuses" in doubts:
            with pytest.raises(AssemblyError):
                assemble_spec(loaded, designed)
            continue
        made += 1
        assert assemble_spec(loaded, designed).modes
    assert made > 100


def rows_of(model):
    yield from model.checks
    for inner in model.__subclasses__():
        yield from rows_of(inner)


def test_every_row_of_every_table_can_be_filled():
    """A brace that is none of a place would stop the reading of a spec that is to be refused."""
    for kind in SPEC_KINDS:
        model_of(kind)
    rows = {id(row): row for row in (*rows_of(SpecModel), *INTERACTION_DOUBTS)}.values()
    assert len(rows) > 100
    for row in rows:
        assert isinstance(row, Row)
        for text in (row.at, row.message, row.remedy):
            for _, name, *_ in Formatter().parse(text):
                assert name is None or re.match(r"\d|s\b", name), text
