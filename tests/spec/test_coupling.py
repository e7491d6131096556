"""What a spec may declare about axes that act on each other, and beside what."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.search.support import TEXT

LOADED = (
    TEXT.replace("GAIN, time_constant: TAU", "4.8417e-4 rad/s/rpm, time_constant: 0.0351 s, LOAD")
    .replace("LOAD", "load_inertia: 1.213 kg*m^2")
    .replace("LOW", "41.5")
    .replace("HIGH", "44.2")
    .replace(
        "CONTROLLERS",
        "  c0: {type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad}",
    )
)
LINKS = "inertia: [0.003 kg*m^2, 0.29 kg*m^2]"


def read(coupling, *, text=LOADED, more=""):
    return parse_spec(f"{text}coupling: {{{coupling}}}\n{more}")


def test_every_field():
    spec = read(
        f"{LINKS}, coriolis: 0.1 N*m*s/rad, speed: 8 deg/s, gravity_gradient: 7 N*m/rad",
        more="contact: kept\n",
    )
    low, high = (end.text for end in spec.coupling.inertia)
    assert (low, high) == ("0.003 kg*m^2", "0.29 kg*m^2")
    assert spec.coupling.gravity_gradient.exact == 7
    assert parse_spec(LOADED).coupling is None


def test_links_may_weigh_nothing():
    assert read("inertia: [0 kg*m^2, 0.29 kg*m^2]").coupling.inertia[0].exact == 0


@pytest.mark.parametrize(
    ("coupling", "words"),
    [
        ("inertia: [0.3 kg*m^2, 0.29 kg*m^2]", "ends at '0.29 kg\\*m\\^2', below its start"),
        ("inertia: [-0.3 kg*m^2, 0.29 kg*m^2]", "coupling"),
        ("inertia: [0.003 kg, 0.29 kg]", "that is a mass"),
        ("coriolis: 0.1 N*m*s/rad, speed: 1 rad/s", "inertia"),
        (f"{LINKS}, coriolis: 0.1 N*m*s/rad", "belong together"),
        (f"{LINKS}, speed: 1 rad/s", "belong together"),
        (f"{LINKS}, gravity_gradient: 7 N/m", "multiply it by the square of its lever arm"),
    ],
)
def test_a_coupling_that_says_nothing_is_refused(coupling, words):
    with pytest.raises(SpecError, match=words):
        read(coupling)


@pytest.mark.parametrize(
    ("text", "more", "words"),
    [
        (LOADED.replace(", load_inertia: 1.213 kg*m^2", ""), "", "the inertia of the drives"),
        (LOADED, "disturbances: {command: 8 deg/s}\n", "depends on the number of axes"),
    ],
)
def test_what_is_not_modelled_with_it_is_refused(text, more, words):
    with pytest.raises(SpecError, match=words):
        read(LINKS, text=text, more=more)


def test_beside_samples_and_disturbances():
    """The load is then that of the links alone; without axes to couple, it is refused."""
    spec = read(
        f"{LINKS}, axes: 3",
        more="sampling: {period: 2 ms, delay: 1}\ndisturbances: {command: 8 deg/s}\n",
    )
    assert spec.coupling.axes == 3
    with pytest.raises(SpecError, match="a load of the motor of one axis beside a sampled loop"):
        parse_spec(f"{LOADED}sampling: {{period: 2 ms, delay: 1}}\n")
    unloaded = LOADED.replace(", load_inertia: 1.213 kg*m^2", "")
    with pytest.raises(SpecError, match="the inertia of the drives"):
        read(LINKS, text=unloaded, more="sampling: {period: 2 ms, delay: 1}\n")


@pytest.mark.parametrize("count", ["0", "2.5", "65"])
def test_a_number_of_axes_that_is_none(count):
    with pytest.raises(SpecError, match="is not an integer from 1 to 64"):
        read(f"{LINKS}, axes: {count}")
