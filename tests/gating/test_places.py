import pytest

from nrs_design.gating.places import SourcePositions
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE


@pytest.fixture
def text_and_places(project):
    def read(name):
        loaded = read_spec(project / "specs" / name)
        return loaded.text.split("\n"), SourcePositions(loaded)

    return read


def test_assembled_modes_stand_at_their_controller(text_and_places):
    lines, places = text_and_places("soft-tissue.nrs.yaml")
    place = places.mode("withdrawal/soft/k-min")
    assert lines[place.line - 1][place.column - 1 :] == "withdrawal:"


def test_a_goal_stands_at_its_controller_or_at_the_top(tmp_path):
    text = SOFT_TISSUE.read_text().replace("switching:", "goals: {min_gain_margin: 2}\nswitching:")
    own = "    desired_impedance_ratio: 0.5\n"
    text = text.replace(own, f"{own}    goals: {{max_sensitivity_peak: 4}}\n")
    path = tmp_path / "goals.nrs.yaml"
    path.write_text(text)
    lines, places = text.split("\n"), SourcePositions(read_spec(path))
    for controller, key in (
        ("withdrawal", "max_sensitivity_peak"),
        ("withdrawal", "min_gain_margin"),
        ("insertion", "min_gain_margin"),
    ):
        place = places.goal(controller, key)
        assert lines[place.line - 1].startswith(key, place.column - 1)


def test_what_is_not_written_out_stands_where_its_holder_does(text_and_places):
    lines, places = text_and_places("stable.nrs.yaml")
    assert places.at("modes", 99) == places.at("modes")
    assert places.at("design") == places.at()
    place = places.at("switching")
    assert lines[place.line - 1].startswith("switching", place.column - 1)
