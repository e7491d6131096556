import pytest

from nrs_design.gating.places import Places
from nrs_design.spec import read_spec


@pytest.fixture
def text_and_places(project):
    def read(name):
        loaded = read_spec(project / "specs" / name)
        return loaded.text.split("\n"), Places(loaded)

    return read


def test_modes_of_given_matrices_stand_in_their_list(text_and_places):
    lines, places = text_and_places("stable.nrs.yaml")
    place = places.mode("b")
    assert lines[place.line - 1][place.column - 1 :].startswith("{name: b")


def test_assembled_modes_stand_at_their_controller(text_and_places):
    lines, places = text_and_places("soft-tissue.nrs.yaml")
    place = places.mode("withdrawal/soft/k-min")
    assert lines[place.line - 1][place.column - 1 :] == "withdrawal:"


def test_what_is_not_written_out_stands_where_its_holder_does(text_and_places):
    lines, places = text_and_places("stable.nrs.yaml")
    assert places.at("modes", 99) == places.at("modes")
    assert places.at("design") == places.at()
    place = places.at("switching")
    assert lines[place.line - 1].startswith("switching", place.column - 1)
