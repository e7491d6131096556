"""Several axes in one file: each is an interaction design, with its places in the file."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import read_spec
from nrs_design.spec.load import axes_at, is_there, read_axes
from tests.support import replaced, spec_in
from tests.tables import rows, spec_text

TEXT = spec_text("two-axes")


@pytest.fixture
def write(tmp_path):
    def written(*changes):
        return spec_in(tmp_path, replaced(TEXT, *changes), "two")

    return written


def test_each_axis_is_a_design(write):
    path = write()
    z, rx = read_axes(path)
    assert [str(item.path) for item in (z, rx)] == [f"{path}#z", f"{path}#rx"]
    assert (z.spec.name, rx.spec.name) == ("two-z", "two-rx")
    assert z.spec.title == "Two axes: z"
    assert (z.spec.axis, rx.spec.axis) == ("prismatic", "rotary")
    assert z.spec.velocity_interface == rx.spec.velocity_interface
    assert z.spec.environments["tissue"].stiffness.nominal.exact == 740
    # As one file of its own says it.
    assert z.sha256 != rx.sha256
    assert read_spec(f"{path}#z").sha256 == z.sha256


def test_places_are_those_of_the_file(write):
    z, rx = read_axes(write())
    assert z.place("environments", "tissue").line == 12
    assert rx.place("environments", "tissue").line == 16
    assert rx.place("sampling", "period").line == 7
    assert rx.place("name").line == 14


@pytest.mark.parametrize(
    ("old", "new", "line", "said"), rows(__file__, "test_what_is_wrong_is_told_at_its_place")
)
def test_what_is_wrong_is_told_at_its_place(write, old, new, line, said):
    path = write((old, new))
    with pytest.raises(SpecError, match=said) as caught:
        read_axes(path)
    assert caught.value.line == line


def test_what_is_asked_of_the_whole_names_the_axes(write):
    path = write()
    with pytest.raises(SpecError, match="holds several axes: z, rx") as caught:
        read_spec(path)
    assert f"{path}#z" in caught.value.remedy
    with pytest.raises(SpecError, match="there is no axis 'ry'") as caught:
        read_spec(f"{path}#ry")
    assert "z, rx" in caught.value.remedy


def test_a_file_without_axes_has_none(tmp_path):
    path = spec_in(tmp_path, "kind: switched-system\nname: one\ntime: discrete\n", "one")
    assert axes_at(path) == (path,)
    with pytest.raises(SpecError, match="holds no axes"):
        read_spec(f"{path}#x")


def test_an_axis_is_there_while_the_file_has_it(write):
    path = write()
    z, gone = (path.with_name(f"{path.name}#{axis}") for axis in ("z", "q"))
    assert is_there(path)
    assert is_there(z)
    assert not is_there(gone)
    path.unlink()
    assert not is_there(z)
