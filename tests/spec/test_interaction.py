import re
from fractions import Fraction

import pytest
from pydantic import ValidationError

from nrs_design.errors import SpecError
from nrs_design.spec import ImpedanceControllerSpec, parse_spec
from nrs_design.spec.controllers import contact_names, touched_in
from nrs_design.spec.describe import describe
from nrs_design.spec.environment import KelvinBoltzmannSpec, MaxwellSpec
from tests.support import SOFT_TISSUE

from .samples import (
    FORCE,
    IMPEDANCE,
    assert_among_faults,
    assert_refused,
    interaction,
    place_of,
    refusal,
    spoiled,
)


def test_reads_quantities_and_defaults() -> None:
    spec = interaction(IMPEDANCE)
    assert spec.name == "sample"
    assert spec.title == ""
    assert spec.motion_loop.damping_ratio == Fraction(707, 1000)
    assert spec.motion_loop.derivative_gain is None
    assert spec.limits.torque.exact == Fraction(3, 10)
    assert spec.design.significant_digits == 4
    assert spec.coordinates == "deflection"
    insertion = spec.controllers["insertion"]
    assert isinstance(insertion, ImpedanceControllerSpec)
    assert insertion.contacts == ("soft",)
    assert insertion.desired_impedance is None
    assert insertion.desired_impedance_ratio is None
    assert insertion.weights.displayed == insertion.weights.sensitivity == Fraction(1, 2)


def test_offset_of_force_controllers() -> None:
    """Thesis 6.41: by default there is none, and all force controllers have the same."""
    assert interaction(FORCE).offset == "none"
    gain = "    proportional_gain: 0.02 rad/(N*m)\n"
    measured = spoiled(FORCE, gain, gain + "    offset: measured\n")
    assert interaction(measured).offset == "measured"
    other = f"  gentle:\n    type: force\n    environment: soft\n{gain}"
    error = refusal(spoiled(measured, "switching:", other + "switching:"))
    assert "'gentle' has offset none, 'force' has measured" in error.message
    error = refusal(spoiled(FORCE, gain, gain + "    offset: position\n"))
    assert "offset" in str(error)


AT_ONCE = spoiled(
    IMPEDANCE, "environment: soft\n", "environment: soft\n    contacts: [[soft, hand]]\n"
)


def test_contacts_touched_at_once() -> None:
    spec = interaction(AT_ONCE)
    insertion = spec.controllers["insertion"]
    assert insertion.contacts == (("soft", "hand"),)
    assert contact_names(insertion.contacts) == ("soft+hand",)
    assert touched_in(insertion.contacts) == ("soft", "hand")
    assert spec.touched == {"soft", "hand"}


def test_environments_may_be_missing_without_contact() -> None:
    head, _, rest = FORCE.partition("environments:\n")
    tail = "controllers:\n  free: {type: position}\nswitching: arbitrary\n"
    assert interaction(head + tail).environments == {}
    error = refusal(head + "controllers:" + rest.partition("controllers:")[2])
    assert "there is no environment 'soft'" in error.message


def test_is_frozen() -> None:
    spec = interaction(IMPEDANCE)
    with pytest.raises(ValidationError, match="frozen"):
        spec.__setattr__("name", "other")


LOOP, WANTED = "  transfer_function: {numerator: ", "    desired_impedance: 2 N*m*s/rad"
# What is replaced in the sample, by what, the piece that the error must point at (in the spoiled
# text), and words of message and remedy.
IMPEDANCE_FAULTS = [
    ("name: sample", "name: Sample", "Sample", "not a name"),
    ("name: sample", "name: ../etc/passwd", "../etc", "not a name"),
    ("name: sample", "name: [a]", "[a]", "single value"),
    ("name: sample", "nane: sample", "nane", "did you mean name?"),
    ("name: sample", "name: sample\ncoupling: 1", "coupling", "`coupling` (keys here are"),
    ("time_constant", "tau", "tau", "did you mean time_constant? keys here are command, gain, "),
    ("damping_ratio:", "zeta:", "zeta", "did you mean damping_ratio?"),
    ("stiffness: 747", "k: 747", "k: ", "did you mean stiffness?"),
    ("type: impedance", "kind: impedance", "insertion", "write type for kind"),
    ("name: sample", 'name: a\ntitle: "a\\nb"', '"a\\nb"', "one line"),
    ("name: sample", 'name: a\ntitle: "\\e[31m"', '"\\e', "printable"),
    ("name: sample", "name: a\ntitle: " + "t" * 201, "ttt", "201 characters"),
    ("  gain: 4.8417e-4 rad/s/rpm\n", "", "actuator", "`actuator.gain` is missing"),
    ("4.8417e-4 rad/s/rpm", "0.145 rad/s/V", "0.145", "commands in V, and the motor takes rpm"),
    ("  gain: 4.8417e-4 rad/s/rpm\n", "  command: W\n  gain: 1 rad/s/V\n", "W", "'rpm', 'V', 'A'"),
    ("0.0351 s", "0 s", "0 s", "must be positive"),
    ("0.0351 s", "{value: 1 s}", "{value", "`actuator.time_constant.nominal` is missing"),
    ("0.707", "1", "1\n  settling", "between 0 and 1"),
    ("0.707", "0", "0\n  settling", "between 0 and 1"),
    ("model: elastic", "model: elastc", "elastc", "did you mean elastic?"),
    ("    model: elastic\n", "", "soft", "`environments.soft.model` is missing"),
    ("747.1461 N/m", "43 N*m/rad", "43 N*m/rad", "remove lever_arm"),
    ("747.1461 N/m", "0 N/m", "0 N/m", "must be positive"),
    (
        "747.1461 N/m",
        "{nominal: 700 N/m, range: [720 N/m, 768 N/m]}",
        "700 N/m",
        "outside the range",
    ),
    ("747.1461 N/m", "{nominal: 1 N/m, range: [1 N/m]}", "[1 N/m]", "[lowest, highest]"),
    ("747.1461 N/m", "{nominal: 1 N/m, range: [1 N*m/rad, 2 N*m/rad]}", "[1 N*m", "one unit"),
    ("747.1461 N/m", "{nominal: 1 N/m, range: [1 N/m, 2 s]}", "2 s", "not a stiffness"),
    ("747.1461 N/m", "{range: [1 N/m, 2 N/m]}", "{range", "nominal` is missing"),
    ("747.1461 N/m", "{nominal: 1 N/m, varies: false}", "false", "a constant that has one value"),
    ("747.1461 N/m", "{nominal: 1 N/m, range: [1 N/m, 2 N/m], varies: 0}", "0}", "true or false"),
    ("    lever_arm: 0.24 m\n", "", "747.1461", "there is no lever_arm"),
    ("    damping: 0.5 N*m*s/rad\n", "", "hand", "damping` is missing"),
    ("0.5 N*m*s/rad", "5 N*s/m", "5 N*s/m", "there is no lever_arm"),
    ("  soft:", "  'so ft':", "'so ft'", "not a name"),
    ("type: impedance", "type: admittance", "admittance", "write impedance: it is called"),
    ("type: impedance", "type: [impedance]", "[impedance]", "write one of impedance"),
    ("type: impedance", "type: impedence", "impedence", "did you mean impedance?"),
    ("environment: soft", "environment: sofd", "sofd", "did you mean soft?"),
    ("    environment: soft\n", "", "insertion", "environment` is missing"),
    ("Mt: 0.01 kg*m^2", "Mt: -0.01 kg*m^2", "-0.01", "zero or positive"),
    ("Mt: 0.01 kg*m^2", "Mt: {min: 1 kg*m^2}", "{min: 1 kg", "max` is missing"),
    ("Mt: 0.01 kg*m^2", "Mt: {min: 2 kg*m^2, max: 1 kg*m^2}", "1 kg*m^2}", "below min"),
    ("min: 0.1 N*m*s/rad", "min: 0 N*m*s/rad", "0 N*m*s/rad, max", "must be positive"),
    ("Mt: 0.01", "mt: 0.01", "insertion", "Mt` is missing"),
    ("switching: arbitrary\n", "", "kind", "`switching` is missing"),
    ("switching: arbitrary", "switching: slow", "slow", "'arbitrary'"),
    ("switching", "coordinates: force\nswitching", "force\nsw", "write 'deflection'"),
    ("switching", "design: {significant_digits: 8}\nswitching", "8}\n", "from 1 to 7"),
    ("switching", "design: {significant_digits: 2.5}\nswitching", "2.5", "from 1 to 7"),
    ("  insertion:", "  free: {type: position}\n  insertion:", "impedance", "is mixed with"),
]


# A line more before another one, the piece of it that the error must point at, and words.
LINE_FAULTS = [
    ("    Mt:", "    contacts: []", "[]", "must not be empty"),
    ("    Mt:", "    contacts: soft", "soft\n    Mt", "expected a list"),
    ("    Mt:", "    contacts: [hand, hand]", "hand]", "listed twice"),
    ("    Mt:", "    contacts: [soft, bone]", "bone", "no environment"),
    ("    Mt:", "    contacts: [hand]", "[hand]", "'soft', but that is not among its contacts"),
    ("    Mt:", "    contacts: [[soft]]", None, "two things at least"),
    ("    Mt:", "    contacts: [[soft, soft]]", None, "touched at once with itself"),
    ("    Mt:", "    contacts: [[soft, hand], [hand, soft]]", None, "'hand+soft' is listed twice"),
    ("    Mt:", "    contacts: [[soft, [hand]]]", None, "expected a single value"),
    ("    Mt:", "    contacts: [[hand, glass]]", None, "there is no environment 'glass'"),
    ("    Mt:", "    desired_impedance_ratio: 0", "0\n    Mt", "not positive"),
    ("    Mt:", f"{WANTED}\n    desired_impedance_ratio: 0.5", "0.5\n    Mt", "exclude each other"),
    ("    Mt:", "    weights: {displayed: 0, sensitivity: 0}", "{displayed", "weights are zero"),
    ("    Mt:", "    weights: {displayed: -1}", "-1}", "zero or positive"),
    ("limits:", f"{LOOP}[1, 2], denominator: [1, 2]}}", "[1, 2], den", "not strictly proper"),
    ("limits:", f"{LOOP}[1], denominator: [0, 2]}}", "0, 2]", "highest coefficient is zero"),
    ("limits:", f"{LOOP}[], denominator: [1, 2]}}", "[], den", "must not be empty"),
]


LINES = [(before, f"{line}\n{before}", *rest) for before, line, *rest in LINE_FAULTS]


@pytest.mark.parametrize(("old", "new", "at", "said"), IMPEDANCE_FAULTS + LINES)
def test_refuses_with_place_and_remedy(old: str, new: str, at: str, said: str) -> None:
    assert_refused(spoiled(IMPEDANCE, old, new), said, at)


@pytest.mark.parametrize(
    ("old", "new", "at", "said"),
    [
        ("    proportional_gain: 0.02 rad/(N*m)\n", "", "force", "neither proportional_gain nor"),
        ("(N*m)\n", "(N*m)\n    damping_ratio: 0.741\n", "0.741", "exclude each other"),
        ("0.02 rad/(N*m)", "0.02 1/(N*m)", "0.02 1/", "write '0.02 rad/(N*m)'"),
        ("0.02 rad/(N*m)", "0.02 rad/N*m", "0.02 rad/N", "not a proportional force gain"),
        ("{type: position}", "{type: position, contacts: [soft]}", "contacts", "unknown key"),
        ("{type: position}", "{kind: position}", "{kind", "type` is missing"),
        ("{type: position}", "position", "position\n", "expected a mapping"),
    ],
)
def test_refuses_force_specs(old: str, new: str, at: str, said: str) -> None:
    assert_refused(spoiled(FORCE, old, new), said, at)


def test_a_controller_is_told_its_own_keys_only() -> None:
    error = refusal(spoiled(FORCE, "{type: position}", "{type: position, contact: [soft]}"))
    assert error.remedy == "keys here are type"


def test_at_least_one_controller() -> None:
    head = IMPEDANCE.partition("controllers:")[0]
    error = refusal(head + "controllers: {}\nswitching: arbitrary\n")
    assert "controllers: must not be empty" in error.message


def test_reports_the_first_fault_and_counts_the_others() -> None:
    text = spoiled(IMPEDANCE, "0.0351 s", "0.0351 m")
    text = spoiled(text, "8 deg/s", "8 m")
    text = spoiled(text, "747.1461 N/m", "nan N/m")
    error = refusal(text)
    assert "actuator.time_constant" in error.message
    assert [(f.line, f.column) for f in error.faults] == [
        place_of(text, "0.0351 m"),
        place_of(text, "8 m"),
        place_of(text, "nan N/m"),
    ]
    assert str(error).endswith("; 2 more faults in this file")
    one = refusal(spoiled(spoiled(IMPEDANCE, "0.0351 s", "0.0351 m"), "8 deg/s", "8 m"))
    assert str(one).endswith("; 1 more fault in this file")


def test_names_may_equal_keys() -> None:
    text = IMPEDANCE.replace("insertion:", "environment:").replace("soft", "model")
    assert set(interaction(text).controllers) == {"environment"}
    error = refusal(spoiled(text, "    Mt: 0.01 kg*m^2\n", "    Mm: 0.01 kg*m^2\n"))
    assert "`controllers.environment.Mt` is missing" in error.message


def test_entries_are_limited() -> None:
    many = "".join(f"  e{i}: {{model: elastic, stiffness: 1 N*m/rad}}\n" for i in range(65))
    error = refusal(spoiled(IMPEDANCE, "  soft:\n", many + "  soft:\n"))
    assert "environments: more than 64 entries are not read" in error.message


BOLTZMANN = (
    "model: kelvin-boltzmann\n    parallel_stiffness: 4 N/m\n    series_stiffness: 17 N/m\n"
    "    damping: {nominal: 400 N*s/m, range: [300 N*s/m, 500 N*s/m]}"
)
MAXWELL = "model: maxwell\n    stiffness: 700 N/m\n    damping: 40 N*s/m"
SOFT = "model: elastic\n    stiffness: 747.1461 N/m"


def test_kelvin_boltzmann() -> None:
    nose = interaction(spoiled(IMPEDANCE, SOFT, BOLTZMANN)).environments["soft"]
    assert isinstance(nose, KelvinBoltzmannSpec)
    turned = nose.at_pivot()
    assert list(turned) == ["parallel_stiffness", "series_stiffness", "damping"]
    assert turned["series_stiffness"].nominal.text == "0.9792 N*m/rad"
    assert turned["damping"].nominal.unit == "N*m*s/rad"
    assert [q.exact for q in turned["damping"].range] == [
        300 * Fraction("0.0576"),
        500 * Fraction("0.0576"),
    ]
    assert not nose.fixed


def test_maxwell_alone() -> None:
    gel = interaction(spoiled(IMPEDANCE, SOFT, MAXWELL)).environments["soft"]
    assert isinstance(gel, MaxwellSpec)
    assert gel.at_pivot()["damping"].nominal.exact == 40 * Fraction("0.0576")


def test_force_control_of_a_kelvin_voigt_spring_is_allowed() -> None:
    text = spoiled(FORCE, "model: elastic", "model: kelvin-voigt\n    damping: 0 N*s/m")
    assert interaction(text).environments["soft"].is_spring


FREE = ("  insertion:", "  free: {type: position}\n  insertion:")
IDLE = ("switching:", "idle_states: {decay: 20 1/s}\nswitching:")


def test_idle_states() -> None:
    mixed = IMPEDANCE.replace(*FREE, 1).replace(*IDLE, 1)
    spec = interaction(mixed)
    assert spec.idle_states is not None
    assert spec.idle_states.decay.exact == 20
    assert not spec.idle_states.reset
    both = interaction(mixed.replace("20 1/s}", "1/2 1/s, reset: true}"))
    assert both.idle_states is not None
    assert both.idle_states.reset


@pytest.mark.parametrize(
    ("changes", "place", "reason"),
    [
        (((SOFT, MAXWELL), ("environment: soft", "environment: soft\n    contacts: [soft, hand]")),
         "maxwell", "has no rest position, beside several environments"),
        (((SOFT, BOLTZMANN), ("nominal: 400", "nominal: 0"), ("300", "0")), "0 N*s/m",
         "must be positive"),
        (((SOFT, BOLTZMANN), ("    series_stiffness: 17 N/m\n", "")), "soft",
         "series_stiffness` is missing"),
        (((SOFT, BOLTZMANN), ("17 N/m", "17 N*m/rad")), "17 N*m", "a lever_arm is given"),
        ((FREE,), "impedance", "it is not said what the states of impedance controllers do"),
        ((IDLE,), "idle_states", "idle_states without impedance controllers beside"),
        ((FREE, IDLE, ("20 1/s", "20 s")), "20 s", "one over it"),
        ((FREE, IDLE, ("20 1/s", "-20 1/s")), "-20 1/s", "zero or positive"),
        ((FREE, IDLE, ("decay: 20 1/s", "reset: true")), "idle_states", "decay` is missing"),
    ],
)  # fmt: skip
def test_refuses_contacts_and_mixtures(
    changes: tuple[tuple[str, str], ...], place: str, reason: str
) -> None:
    text = IMPEDANCE
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    assert_among_faults(text, reason, place)


@pytest.mark.parametrize("name", ["motion", "miss"])
def test_no_controller_is_called_like_other_modes(name):
    """Gains are listed by these names, and so are modes in which no law is computed."""
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    with pytest.raises(SpecError, match=f"controller cannot be called '{name}'"):
        parse_spec(text.replace("  insertion:", f"  {name}:"))


@pytest.mark.parametrize(
    "name", ["free", "tau-min", "flow-2", "h0-min", "in1-max", "k-max", "delay-1"]
)
def test_no_environment_is_called_like_what_names_of_modes_end_with(name):
    text = SOFT_TISSUE.read_text()
    with pytest.raises(SpecError, match=f"cannot be called '{name}'"):
        parse_spec(
            re.sub(
                r"\bsoft:", f"{name}:", text.replace("environment: soft", f"environment: {name}")
            )
        )


FRICTION = "sampling: {period: 2 ms, delay: 0}\ndisturbances: {friction: 55 counts}\n"
INTERVALS = (
    "time_constant: 0.0351 s\n  intervals: "
    "{gain: [145 rad/s/mV, 146 rad/s/rpm], time_constant: [35 ms, 36 ms]}"
)
VOLTS = spoiled(IMPEDANCE, "gain: 4.8417e-4 rad/s/rpm", "command: V\n  gain: 145.2 rad/s/mV")


def test_a_motor_that_takes_volts():
    spec = interaction(VOLTS)
    assert (spec.actuator.command, spec.actuator.gain.nominal.si) == ("V", 145200.0)
    rows = {row.name: row for row in describe(spec)}
    assert rows["actuator.gain"][1:] == ("145.2 rad/s/mV", "145200", "rad/s/V")
    assert rows["actuator.command"].written == "V"
    assert interaction(IMPEDANCE).actuator.command == "rpm"


@pytest.mark.parametrize(
    ("old", "new", "at"),
    [
        ("time_constant: 0.0351 s", INTERVALS, "{gain: [145"),
        ("0.1404 s", "0.1404 s\n  derivative_gain: 2060 rpm*s/rad", "2060"),
        ("0.1404 s", "0.1404 s\n  derivative_gain: 7 A*s/rad", "7 A"),
        ("switching:", FRICTION + "switching:", "55 counts"),
        ("bandwidth: 2 Hz}", "bandwidth: 2 Hz, command: 4000 rpm}", "4000 rpm"),
    ],
)
def test_everything_about_commands_is_in_the_unit_of_the_motor(old, new, at):
    error = refusal(spoiled(VOLTS, old, new))
    assert "the motor takes V" in error.message
    place = place_of(spoiled(VOLTS, old, new), at)
    assert error.line == place[0]
