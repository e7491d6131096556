"""What each line of a spec could ask for instead."""

from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.spec import LoadedSpec, parse_spec
from nrs_design.spec.document import to_data
from nrs_design.spec.edits import changed, with_edits
from nrs_design.spec.load import respecified
from nrs_design.spec.relaxations import PARTS, SpecRelaxation, calmer, iterate_relaxations
from nrs_design.spec.spec_weakening import find_changes
from tests.support import FORCE_LIMIT, ROOT, SOFT_TISSUE
from tests.tables import edited, table

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad"
STIFFNESS = "environments.soft.stiffness.range"
CONSTANT = "environments.soft.stiffness.varies"
CONTROLLERS = ["controllers.insertion", "controllers.withdrawal"]
PARTS_OF = table(Path(__file__).with_suffix(".yaml"))["parts"]


def loaded(text: str) -> LoadedSpec:
    return LoadedSpec(path=Path("a.nrs.yaml"), sha256="", text=text, spec=parse_spec(text))


def lines_of(spec: LoadedSpec, slowest: float | None = None) -> dict[str, SpecRelaxation]:
    return {".".join(map(str, line.at)): line for line in iterate_relaxations(spec, slowest)}


def at_least(spec: LoadedSpec, line: SpecRelaxation) -> LoadedSpec:
    return respecified(spec, with_edits(spec.root, [line.edit(line.weakest, 0)]))


@pytest.mark.parametrize("name", PARTS_OF)
def test_a_line_is_named_where_it_is_there_and_a_spec_without_it_is_valid(name):
    assert set(lines_of(loaded(TEXT))) == {STIFFNESS, CONSTANT, *CONTROLLERS}
    spec = loaded(edited(TEXT, PARTS_OF[name]))
    line = lines_of(spec)[name]
    assert name not in lines_of(at_least(spec, line))


def test_less_is_asked_for_at_every_step_and_all_at_the_last():
    spec = loaded(TEXT)
    line = lines_of(spec)[STIFFNESS]
    said = to_data(spec.root)
    for way in (line.weakest, *line.alternatives):
        for step in range(way.size):
            less = respecified(spec, changed(spec.root, line.at, way.value_at(step)))
            found = list(find_changes(spec.spec, less.spec))
            assert [change.weaker for change in found] == [True]
        assert to_data(changed(spec.root, line.at, way.value_at(way.size))) == said


@given(
    st.fractions(-1000, 1000, max_denominator=10**6),
    st.fractions(Fraction(1, 10**6), 1000, max_denominator=10**6),
    st.fractions(Fraction(1, 10**6), 1000, max_denominator=10**6),
)
def test_ends_are_rounded_towards_the_nominal_value_and_never_leave_the_range(center, below, above):
    numbers = [f'"{number}"' for number in (center, center - below, center + above)]
    text = "kind: switched-system\nname: a\ntime: continuous\nparameters:\n  k: "
    text += f"{{nominal: {numbers[0]}, range: [{numbers[1]}, {numbers[2]}]}}\n"
    text += "modes: [{name: m, A: [[k]]}]\nswitching: arbitrary\n"
    line = lines_of(loaded(text))["parameters.k.range"]
    both, up, down = line.weakest, *line.alternatives
    last = (center, center)
    for step in (0, 1, 7, PARTS // 2, PARTS - 1, PARTS):
        low, high = map(Fraction, both.value_at(step))
        assert center - below <= low <= last[0] <= center <= last[1] <= high <= center + above
        assert center - low <= below * step / PARTS
        assert high - center <= above * step / PARTS
        assert step == 0 or (high - center) > above * (step - Fraction(1, 2)) / PARTS
        assert (Fraction(up.value_at(step)[1]), Fraction(down.value_at(step)[0])) == (high, low)
        last = low, high


def test_a_range_of_times_keeps_its_shortest():
    text = TEXT + "\nsampling: {period: 2 ms, delay: 0, latency: [0.3 ms, 1 ms]}\n"
    form = lines_of(loaded(text))["sampling.latency"].weakest
    assert form.value_at(0) == ("0.3 ms", "0.3 ms")
    assert form.value_at(PARTS) == ("0.3 ms", "1 ms")
    assert (form.label_at(PARTS // 2), form.requested) == ("0.65 ms", "1 ms")
    one = TEXT + "\nsampling: {period: 2 ms, delay: 0, latency: 1 ms}\n"
    assert "sampling.latency" not in lines_of(loaded(one))


def test_a_dwell_time_begins_where_every_mode_has_decayed():
    text = (ROOT / "specs/examples/commuting.nrs.yaml").read_text(encoding="utf-8")
    line = lines_of(loaded(text), 0.5)["switching"]
    steps = map(line.weakest.value_at, range(line.weakest.size))
    times = [Fraction(said["dwell_time"].removesuffix(" s")) for said in steps]
    assert times == sorted(times, reverse=True)
    assert times[0] == 128
    assert times[-1] < Fraction(1, 100)
    assert line.weakest.value_at(line.weakest.size) == "arbitrary"
    assert "switching" not in lines_of(loaded(text))


def test_given_gains_of_all_controllers_change_together():
    """Bounds move as one; a gain that is designed from something else is not given."""
    lines = calmer(loaded(TEXT.replace(BT, "Bt: {min: 0.1 N*m*s/rad, max: 1.5 N*m*s/rad")), 2, 4)
    assert [line.edit(line.weakest, 0) for line in lines] == [
        (("controllers", name, "Bt"), {"min": "0.2 N*m*s/rad", "max": f"{top} N*m*s/rad"})
        for name, top in (("insertion", 3), ("withdrawal", 3))
    ]
    (force,) = calmer(loaded(FORCE_LIMIT.read_text(encoding="utf-8")), 2, 4)
    assert force.weakest.value_at(0) == "0.005 rad/(N*m)"
