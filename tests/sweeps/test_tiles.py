"""What a spec says in tiles and boxes."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import read_spec
from nrs_design.sweeps.tiles import TileCut, read_tiles
from tests.support import ROOT

SAMPLED = ROOT / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"


def tiles(*said, path=SAMPLED):
    return read_tiles(read_spec(path), path, list(said))


def test_a_range_is_cut_into_intervals():
    grid = tiles("environments.soft.stiffness=100..900/4 N/m")
    (field,) = grid.fields
    assert (field.cut, field.count) == (TileCut.INTERVAL, 4)
    assert field.values == (100, 300, 500, 700, 900)
    assert [field.text(k) for k in range(4)][1] == "300..500 N/m"
    stiffness = grid.spec_of(((1, 2),)).spec.environments["soft"].stiffness
    assert [end.text for end in stiffness.range] == ["300 N/m", "700 N/m"]
    assert stiffness.nominal.text == "500 N/m"


def test_of_a_range_the_upper_end_takes_each_value():
    grid = tiles("sampling.delay=0..3")
    (field,) = grid.fields
    assert (field.cut, field.count, field.text(2)) == (TileCut.UP_TO, 4, "2")
    assert grid.spec_of(((0, 2),)).spec.sampling.delay == (0, 2)


def test_values_by_themselves():
    grid = tiles("sampling.period=1,2,4 ms")
    (field,) = grid.fields
    assert (field.cut, field.count) == (TileCut.POINT, 3)
    assert grid.spec_of(((2, 2),)).spec.sampling.period.text == "4 ms"
    words = tiles("contact=kept,losable").fields[0]
    assert (words.cut, words.text(1)) == (TileCut.POINT, "losable")


@pytest.mark.parametrize(
    ("said", "words"),
    [
        # Gains would be others in a box than in its tiles.
        ("limits.bandwidth=1,2 Hz", "is about gains"),
        ("controllers.insertion.Bt.min=1,2 N*m*s/rad", "is about gains"),
        # Tiles lie between values, and below them.
        ("sampling.delay=0,6,1", "do not ascend"),
        ("environments.soft.stiffness=500,400 N/m", "do not ascend"),
        # A list of two need not be a range.
        ("environments.soft.stiffness.range=700..900/3 N/m", "is a list"),
    ],
)
def test_what_is_no_map(said, words):
    with pytest.raises(SpecError, match=words):
        tiles(said)


def test_a_row_of_a_matrix_is_no_range():
    path = ROOT / "specs" / "examples" / "dayawansa-martin-5.nrs.yaml"
    with pytest.raises(SpecError, match="is a list"):
        tiles("modes.0.A.0=-3..3", path=path)
    assert tiles("modes.0.A.0.1=-3..3", path=path).fields[0].cut is TileCut.POINT


def test_whole_numbers_are_borders_by_themselves():
    (field,) = tiles("environments.soft.stiffness=700..704 N/m").fields
    assert [field.text(k) for k in range(field.count)][:2] == ["700..701 N/m", "701..702 N/m"]


def test_an_axis_of_several_is_no_file_of_its_own():
    path = ROOT / "docs" / "examples" / "six-axes.nrs.yaml#x"
    with pytest.raises(SpecError, match="a map is of a spec with one axis"):
        tiles("sampling.delay=0..1", path=path)


def test_the_text_of_a_box_says_the_same():
    grid = tiles("environments.soft.stiffness=100..900/4 N/m", "sampling.delay=0..3")
    box = ((0, 3), (1, 1))
    text = grid.text_of(box)
    assert "# A period of 2 ms" in text
    assert "[100 N/m, 900 N/m]" in text
    assert "delay: [0, 1]" in text


def test_too_many_tiles():
    with pytest.raises(SpecError, match="500 x 200 = 100000 tiles are more than 65536"):
        tiles("environments.soft.stiffness=100..900/500 N/m", "sampling.period=1..2/200 ms")


def test_a_field_that_is_not_there():
    with pytest.raises(SpecError, match="there is no field"):
        tiles("environments.hard.stiffness=1..2/2 N/m")
