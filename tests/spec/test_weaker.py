"""What counts as weaker: a table of edits of one spec, and properties of the comparison."""

import json
import re
from types import NoneType
from typing import get_args

import pytest
from pydantic import TypeAdapter, ValidationError

from nrs_design.spec import parse_spec
from nrs_design.spec.controllers import (
    ForceControllerSpec,
    ImpedanceControllerSpec,
    IntegralControllerSpec,
    TorqueImpedanceSpec,
)
from nrs_design.spec.document import parse_document, to_data
from nrs_design.spec.environment import (
    ElasticSpec,
    HandSpec,
    HuntCrossleySpec,
    KelvinBoltzmannSpec,
    KelvinVoigtSpec,
    MaxwellSpec,
)
from nrs_design.spec.goals import AccuracySpec, GoalsSpec, TransparencySpec
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.interaction_parts import AbstractInteractionSpec
from nrs_design.spec.load import read_axes
from nrs_design.spec.model import Declared, SpecModel, declared_in
from nrs_design.spec.monitoring import MonitoringSpec
from nrs_design.spec.motion import (
    ActuatorSpec,
    PositionInterfaceSpec,
    TorqueInterfaceSpec,
    VelocityInterfaceSpec,
)
from nrs_design.spec.parameters import ParameterSpec
from nrs_design.spec.preload import ExponentSpec
from nrs_design.spec.provenance import IdentifiedRangesSpec
from nrs_design.spec.quantity_fields import RangedQuantity
from nrs_design.spec.robot import RobotSpec, TaskLimitsSpec
from nrs_design.spec.sampling import DisturbancesSpec, SamplingSpec
from nrs_design.spec.scenarios import (
    ErrorsSpec,
    ScenarioLimitsSpec,
    SignControlSpec,
    SinusoidSpec,
    SurfaceSpec,
    ThresholdControlSpec,
)
from nrs_design.spec.sensor import CenterSpec, PointSpec, SensorSpec, ToolSpec
from nrs_design.spec.switched_system import SwitchedSystemSpec
from nrs_design.spec.threshold_logic import (
    CommandCondition,
    CommandSignalSpec,
    TorqueCondition,
    TorqueSignalSpec,
)
from nrs_design.spec.weaker import find_changes
from tests.support import ROOT

# Fields are read as those of a spec are; what may not stand beside what is for others to say.
TEXT = """\
kind: interaction-design
name: a
title: words
actuator:
  gain: {nominal: 4.8e-4 rad/s/rpm, range: [4.7e-4 rad/s/rpm, 4.9e-4 rad/s/rpm]}
  time_constant: 0.0351 s
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
sensor: {bias: 0.1 N*m, filter: {order: 2, cutoff: 30 Hz}, tool: {mass: 0.8 kg,
  center_of_mass: {x: 0 m, y: 0 m, z: 0.1 m}}}
environments:
  soft:
    model: kelvin-voigt
    stiffness: {nominal: 747 N/m, range: [720 N/m, 768 N/m]}
    damping: 5 N*s/m
    lever_arm: 0.24 m
    doubts: [too short, too slow]
  hard:
    model: hunt-crossley
    stiffness: 900 N/m
    damping: 1 N*s/m
    exponent: 1.2
    about: 0.2 m
    preload: [0.1 m, 0.3 m]
    lever_arm: 0.2 m
controllers:
  insertion: {type: impedance, environment: soft, contacts: [soft, hard], Mt: 0.01 kg*m^2,
    Bt: 2 N*m*s/rad, goals: {min_phase_margin: 30 deg}}
  withdrawal: {type: force, environment: soft, proportional_gain: 0.02 rad/(N*m)}
  own: {type: force, environment: soft, proportional_gain: 0.03 rad/(N*m)}
goals: {max_sensitivity_peak: 2, min_gain_margin: 1.5, transparency: {max_impedance: 3 N*m*s/rad,
  band: [0.5 Hz, 2 Hz]}, accuracy: {max_error: 0.1, band: [0 Hz, 1 Hz]}, peak_torque: 0.5 N*m,
  delay: 2 ms, initial_force: 0.4 N*m}
disturbances: {command: 8 deg/s}
sampling: {period: 2 ms, delay: [0, 1], latency: [0.3 ms, 1 ms], jitter: 0.1 ms}
scenarios:
  hit: {command: {constant: 8 deg/s}, limits: {torque: 0.5 N*m}, duration: 3 s,
    errors: {friction: 100 rpm}}
  touch: {command: {constant: 8 deg/s}, duration: 4 s,
    control: {contact: {soft: own, hard: withdrawal}}}
mode_logic:
  type: thresholds
  start: design
  signals: {torque: {noise: 0.1 N*m, age: 2 ms, largest_rate: 1 N*m/s}}
  switches: [{from: design, to: own, torque: {above: 1 N*m}}]
  hold: {design: 10 ms}
switching: arbitrary
contact: losable
certification: {budget: 10}
"""
SWITCHED = """\
kind: switched-system
name: b
time: continuous
modes:
  - {name: fast, A: [[-1, 1], [-1, -1]]}
  - {name: slow, A: [[-2, 0], [0, -2]]}
switching:
  dwell_time: 0.2 s
  longest_dwell_time: {fast: 2 s}
  transitions: [[fast, slow], [slow, fast]]
"""
UNCERTAIN = """\
kind: switched-system
name: d
time: continuous
modes: [{name: m, A: [[-1, k], [0, -1]]}, {name: n, A: [[-1, 0], [0, -1]]}]
parameters: {k: {nominal: 1, range: [0.5, 2], varies: true}}
switching: arbitrary
"""
HARD = TEXT[TEXT.index("  hard:") : TEXT.index("controllers:")]
WITHDRAWAL = "  withdrawal: {type: force, environment: soft, proportional_gain: 0.02 rad/(N*m)}\n"
ELSEWHERE = "7.5 N/mm, range: [7 N/mm, 8 N/mm]"
LIGHTER = "mass: {nominal: 0.5 kg, range: [0.4 kg, 0.6 kg]}"
SLOWER = "{constant: 4 deg/s}, limits"
SWAPPED = "{hard: withdrawal, soft: own}"
OWN_HARD = "own: {type: force, environment: hard"
WEAKER = {
    "constant stiffness": ("[720 N/m, 768 N/m]}", "[720 N/m, 768 N/m], varies: false}"),
    "constant motor": ("4.9e-4 rad/s/rpm]}", "4.9e-4 rad/s/rpm], varies: false}"),
    "range": ("[720 N/m, 768 N/m]", "[730 N/m, 768 N/m]"),
    "range in another unit": ("[720 N/m, 768 N/m]", "[0.73 N/mm, 0.8 N/mm]"),
    "range that is elsewhere": ("747 N/m, range: [720 N/m, 768 N/m]", ELSEWHERE),
    "no range": ("{nominal: 747 N/m, range: [720 N/m, 768 N/m]}", "747 N/m"),
    "nominal only": (", range: [4.7e-4 rad/s/rpm, 4.9e-4 rad/s/rpm]", ""),
    "contact": ("contact: losable", "contact: kept"),
    "contact unsaid": ("contact: losable\n", ""),
    "switching": ("switching: arbitrary", "switching: {dwell_time: 1 s}"),
    "largest goal": ("max_sensitivity_peak: 2", "max_sensitivity_peak: 2.5"),
    "least goal": ("min_gain_margin: 1.5", "min_gain_margin: 1.4"),
    "goal in another unit": ("delay: 2 ms", "delay: 0.001 s"),
    "own goal": ("min_phase_margin: 30 deg", "min_phase_margin: 29 deg"),
    "largest impedance that is felt": ("max_impedance: 3 N", "max_impedance: 3.1 N"),
    "band": ("[0.5 Hz, 2 Hz]", "[0.5 Hz, 1.9 Hz]"),
    "band in another unit": ("[0.5 Hz, 2 Hz]", "[4 rad/s, 12 rad/s]"),
    "a goal": (", min_gain_margin: 1.5", ""),
    "bound on the torque": ("peak_torque: 0.5 N*m", "peak_torque: 600 N*mm"),
    "disturbance": ("{command: 8 deg/s}", "{command: 7 deg/s}"),
    "limit of a scenario": ("limits: {torque: 0.5 N*m}", "limits: {torque: 0.6 N*m}"),
    "limit of the torque": ("torque: 0.3 N*m", "torque: 0.4 N*m"),
    "a controller": (WITHDRAWAL, ""),
    "a contact": ("[soft, hard]", "[soft]"),
    "an environment": (HARD, ""),
    "ages": ("delay: [0, 1]", "delay: [0, 0]"),
    "times of commands": ("[0.3 ms, 1 ms]", "[0.3 ms, 0.9 ms]"),
    "one time of commands": ("[0.3 ms, 1 ms]", "0.3 ms"),
    "jitter": ("jitter: 0.1 ms", "jitter: 0.05 ms"),
    "no jitter": (", jitter: 0.1 ms", ""),
    "sampling": (
        "sampling: {period: 2 ms, delay: [0, 1], latency: [0.3 ms, 1 ms], jitter: 0.1 ms}\n",
        "",
    ),
    "one value of what is touched": ("stiffness: 900 N/m", "stiffness: 9 N/m"),
    "law of what is touched": ("model: kelvin-voigt", "model: maxwell"),
    "preload": ("[0.1 m, 0.3 m]", "[0.2 m, 0.21 m]"),
    "lever arm": ("0.24 m", "0.1 m"),
    "bias": ("bias: 0.1 N*m", "bias: 0.01 N*m"),
    "noise": ("noise: 0.1 N*m", "noise: 0.01 N*m"),
    "age": ("age: 2 ms", "age: 1 ms"),
    "hold": ("{design: 10 ms}", "{design: 1 s}"),
    "period": ("period: 2 ms", "period: 1 ms"),
    "friction in a scenario": ("friction: 100 rpm", "friction: 10 rpm"),
    "duration": ("duration: 3 s", "duration: 1 s"),
    "goal of the whole spec replaced": (
        "0.03 rad/(N*m)}",
        "0.03 rad/(N*m), goals: {max_sensitivity_peak: 100}}",
    ),
    "own environment not in contacts": ("0.03 rad/(N*m)}", "0.03 rad/(N*m), contacts: [hard]}"),
    "own environment": ("own: {type: force, environment: soft", OWN_HARD),
    "limit that is no number": ("initial_force: 0.4 N*m", "initial_force: largest"),
    "bandwidth": ("bandwidth: 2 Hz", "bandwidth: 1 Hz"),
    "command of a run": ("{constant: 8 deg/s}, limits", SLOWER),
    "start of the logic": ("start: design", "start: own"),
    "one mass of the tool": ("mass: 0.8 kg", LIGHTER),
    "who is in force in a run": ("contact: {soft: own, hard: withdrawal}", "fixed: own"),
    "who is in force in a run at first": ("{soft: own, hard: withdrawal}", SWAPPED),
    "a doubt accepted": ("too slow]", "too slow]\n    accept_doubt: because"),
    "a doubt removed": ("[too short, too slow]", "[too short]"),
}
NEITHER = {
    *("[0.73 N/mm, 0.8 N/mm]", ELSEWHERE, "stiffness: 9 N/m", "model: maxwell", "0.1 m"),
    *(
        SLOWER,
        "start: own",
        LIGHTER,
        "fixed: own",
        SWAPPED,
        OWN_HARD,
        "0.03 rad/(N*m), contacts: [hard]}",
    ),
    *("dwell_time: {fast: 0.2 s, slow: 0.2 s}", "initial_force: largest"),
}
OTHER = {
    "words": ("title: words", "title: other words"),
    "motor": ("0.0351 s", "0.0352 s"),
    "wider": ("[720 N/m, 768 N/m]", "[700 N/m, 768 N/m]"),
    "nominal": ("nominal: 747 N/m", "nominal: 748 N/m"),
    "a range more": ("stiffness: 900 N/m", "stiffness: {nominal: 900 N/m, range: [1 N/m, 1 N/mm]}"),
    "wider band": ("[0.5 Hz, 2 Hz]", "[0 Hz, 13 rad/s]"),
    "stricter": ("max_sensitivity_peak: 2", "max_sensitivity_peak: 1.9"),
    "another gain": ("Bt: 2 N*m*s/rad", "Bt: 3 N*m*s/rad"),
    "search": ("budget: 10", "budget: 1"),
    "no search": ("certification: {budget: 10}\n", ""),
    "filter": ("cutoff: 30 Hz", "cutoff: 20 Hz"),
    "own goal that is stricter": (
        "0.03 rad/(N*m)}",
        "0.03 rad/(N*m), goals: {max_sensitivity_peak: 1.5}}",
    ),
    "a goal more": ("delay: 2 ms,", "delay: 2 ms, decay_rate: 1 1/s,"),
}
SWITCHED_WEAKER = {
    "dwell time": ("dwell_time: 0.2 s", "dwell_time: 0.3 s"),
    "longest dwell time": ("{fast: 2 s}", "{fast: 1 s}"),
    "transition": ("[[fast, slow], [slow, fast]]", "[[fast, slow]]"),
    "dwell time of one": ("dwell_time: 0.2 s", "dwell_time: {fast: 0.2 s, slow: 0.2 s}"),
    "longest dwell time of another": ("{fast: 2 s}", "{fast: 2 s, slow: 1 s}"),
}
SWITCHED_OTHER = {
    "shorter": ("dwell_time: 0.2 s", "dwell_time: 0.1 s"),
    "all": (
        "  dwell_time: 0.2 s\n  longest_dwell_time: {fast: 2 s}\n"
        "  transitions: [[fast, slow], [slow, fast]]\n",
        "",
    ),
    "entry": ("[[-2, 0]", "[[-3, 0]"),
}


SPEC = """\
kind: interaction-design
name: a
actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}
motion_loop:
  {damping_ratio: 0.707, settling_time: 0.1404 s, derivative_gain: 2060 rpm*s/rad,
   zero: 56.9706 1/s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz, command: 9000 rpm}
environments:
  soft: {model: elastic, stiffness: 747 N/m, lever_arm: 0.24 m}
controllers:
  insertion: {type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: 2 N*m*s/rad}
sampling: {period: 2 ms, delay: 0, latency: [0.1 ms, 0.5 ms]}
switching: {SWITCHING}
"""
STEPS = """\
kind: switched-system
name: b
time: discrete
modes: [{name: works, A: [[0.5]]}, {name: title, A: [[0.4]]}]
switching: {dwell_time: {title: 2 steps, works: 2 steps}, longest_dwell_time: {title: 900 steps}}
"""
ARBITRARY = SPEC.replace("{SWITCHING}", "arbitrary")
DISPLAYED = ARBITRARY.replace("Mt:", "desired_impedance: 2 N*m*s/rad, Mt:")
# Spec, an edit of it, and whether it is weaker there and back.
READ = [
    (UNCERTAIN, ", {name: n, A: [[-1, 0], [0, -1]]}", "", True, False),
    (UNCERTAIN, "[0.5, 2]", "[0.6, 2]", True, False),
    (UNCERTAIN, "{nominal: 1, range: [0.5, 2], varies: true}", "{nominal: 3}", True, True),
    (UNCERTAIN, "varies: true", "varies: false", True, False),
    (STEPS, "works: 2 steps", "works: 200 steps", True, False),
    (STEPS, "title: 2 steps", "title: 200 steps", True, False),
    (STEPS, "title: 900 steps", "title: 800 steps", True, False),
    (STEPS, "{title: 900 steps}", "900 steps", True, True),
    (STEPS, "longest_dwell_time: {title: 900 steps}", "transitions: []", True, True),
    (STEPS, "A: [[0.4]]", "A: [[0.3]]", False, False),
    (STEPS, "A: [[0.4]]", "A: [[2/5]]", False, False),
    (ARBITRARY, "command: 9000 rpm", "command: 12000 rpm", True, False),
    (ARBITRARY, "velocity: 8 deg/s", "velocity: 9 deg/s", True, True),
    (ARBITRARY, "[0.1 ms, 0.5 ms]", "{range: [0.2 ms, 0.3 ms], varies: false}", True, False),
    (ARBITRARY, "[0.1 ms, 0.5 ms]", "{range: [0.1 ms, 0.5 ms], varies: false}", True, False),
    (ARBITRARY, "[0.1 ms, 0.5 ms]", "{range: [0.1 ms, 0.5 ms], varies: true}", False, False),
    (ARBITRARY, "[0.1 ms, 0.5 ms]", "0.3 ms", True, False),
    (ARBITRARY, "delay: 0", "delay: 0, admittance: exact", False, False),
    (ARBITRARY, "delay: 0", "delay: [0, 0]", False, False),
    (ARBITRARY, "delay: 0", "delay: 2", False, True),
    (DISPLAYED, "desired_impedance: 2", "desired_impedance: 3", True, True),
    (DISPLAYED, "desired_impedance: 2 N*m*s/rad", "desired_impedance_ratio: 2", True, True),
    (ARBITRARY, "period: 2 ms", "period: 0.002 s", False, False),
    (ARBITRARY, "velocity: 8 deg/s", "velocity: 8.0 deg/s", False, False),
    (ARBITRARY, "lever_arm: 0.24 m", "lever_arm: 240 mm", False, False),
    (ARBITRARY, "time_constant: 0.0351 s", "time_constant: {nominal: 35.1 ms}", False, False),
    (ARBITRARY, "747 N/m", "{nominal: 747 N/m, range: [740 N/m, 750 N/m]}", False, True),
]


@pytest.mark.parametrize(("text", "old", "new", "there", "back"), READ)
def test_specs_are_compared_by_what_they_mean(text, old, new, there, back):
    said = [parse_spec(content) for content in (text, edited(text, old, new))]
    assert any(change.weaker for change in find_changes(*said)) is there
    assert any(change.weaker for change in find_changes(*reversed(said))) is back


def spec_of(text):
    """Read the fields of a spec, without the checks between its parts."""
    model = AbstractInteractionSpec if "interaction-design" in text else SwitchedSystemSpec
    return model.model_validate(to_data(parse_document(text)))


def edited(text, old, new):
    assert text.count(old) == 1, old
    after = text.replace(old, new)
    return after.replace("switching:\n", "switching: arbitrary\n") if after[-2:] == ":\n" else after


def changes(before, after):
    return list(find_changes(spec_of(before), spec_of(after)))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("duration: 3 s", "duration: 3 s, start: -9 deg"),
        ("duration: 3 s", "duration: 3 s, wanted_torque: 1 N*mm"),
        ("duration: 3 s", "duration: 3 s, control: {fixed: own}"),
        ("controllers:\n", "controllers:\n  first: {type: position}\n"),
        ("period: 2 ms", "period: 2 ms, outer_period: 1 ms"),
        ("Bt: 2", "desired_impedance: 9 N*m*s/rad, Bt: 2"),
        ("max_error: 0.1", "max_error: 0.1, environment: soft"),
    ],
)
def test_what_takes_the_place_of_what_holds_unsaid_is_weaker(old, new):
    logic = TEXT[TEXT.index("mode_logic:") : TEXT.index("switching:")]
    before = TEXT.replace(logic, "") if "first" in new else TEXT
    assert any(change.weaker for change in changes(before, edited(before, old, new)))


UNSAID_WEAKER = {
    "contact": (TEXT, "contact: losable\n", "contact: kept\n"),
    "varies": (UNCERTAIN, ", varies: true", ", varies: false"),
}


@pytest.mark.parametrize(
    ("text", "edit"),
    [
        *(pytest.param(TEXT, edit, id=name) for name, edit in WEAKER.items()),
        *(pytest.param(SWITCHED, edit, id=name) for name, edit in SWITCHED_WEAKER.items()),
    ],
)
def test_weaker(text, edit):
    """And the way back is not, unless both cover what the other does not."""
    after = edited(text, *edit)
    found = changes(text, after)
    assert any(change.weaker for change in found), found
    back = any(change.weaker for change in changes(after, text))
    assert back is (edit[1] in NEITHER)


@pytest.mark.parametrize(
    ("text", "edit"),
    [
        *(pytest.param(TEXT, edit, id=name) for name, edit in OTHER.items()),
        *(pytest.param(SWITCHED, edit, id=name) for name, edit in SWITCHED_OTHER.items()),
    ],
)
def test_other_changes_are_listed_and_are_not_weaker(text, edit):
    found = changes(text, edited(text, *edit))
    assert found
    assert not any(change.weaker for change in found), found


@pytest.mark.parametrize("case", UNSAID_WEAKER)
def test_to_say_what_is_weaker_than_the_default_is_weaker(case):
    text, strong, weak = UNSAID_WEAKER[case]
    unsaid = text.replace(strong, "\n" * strong.count("\n"))
    assert any(change.weaker for change in changes(unsaid, text.replace(strong, weak)))
    assert not any(change.weaker for change in changes(unsaid, text))
    assert not any(change.weaker for change in changes(text.replace(strong, weak), unsaid))


@pytest.mark.parametrize(
    "rules", ["{dwell_time: 9 s}", "mode-logic", "{transitions: [[insertion, withdrawal]]}"]
)
def test_of_two_restrictions_of_switching_neither_holds_the_other(rules):
    before = TEXT.replace("switching: arbitrary", "switching: {longest_dwell_time: {own: 1 s}}")
    after = TEXT.replace("switching: arbitrary", f"switching: {rules}")
    assert any(change.weaker for change in changes(before, after))


def test_a_name_is_no_word_of_ours():
    before = TEXT.replace("  hard:", "  title:").replace("withdrawal:", "mode_logic:")
    after = before.replace("stiffness: 900 N/m", "stiffness: 9 N/m")
    assert any(change.weaker for change in changes(before, after))
    without = before.replace(WITHDRAWAL.replace("withdrawal:", "mode_logic:"), "")
    assert any(change.weaker for change in changes(before, without))


RANGED = {RangedQuantity, ExponentSpec, ParameterSpec}
# Of these any other value is weaker, of the others one that is larger or smaller.
EITHER = (
    *(ElasticSpec, KelvinVoigtSpec, HandSpec, MaxwellSpec, HuntCrossleySpec, KelvinBoltzmannSpec),
    *(ToolSpec, CenterSpec, PointSpec, MonitoringSpec, TaskLimitsSpec, SinusoidSpec, SurfaceSpec),
    *(CommandCondition, TorqueCondition, ThresholdControlSpec, SignControlSpec),
)
BORNE = (
    *(DisturbancesSpec, SensorSpec, SamplingSpec, GoalsSpec, TransparencySpec, AccuracySpec),
    *(TorqueSignalSpec, CommandSignalSpec, ErrorsSpec, ScenarioLimitsSpec),
)
# Parts, which are compared by their own fields, and values that no two guesses fit.
PARTS = {"filter", "tool", "pivot", "misses", "transparency", "accuracy", "model"}
PARTS |= {"center_of_mass", "surface", "side", "parameters"}
WORDS = {*IdentifiedRangesSpec.model_fields, "linearized_about", "admittance"}


def values_of(model, key, *each):
    """Read a field once for each of some values."""
    field = TypeAdapter(model.model_fields[key].rebuild_annotation())
    return [model.model_construct(**{key: field.validate_python(value)}) for value in each]


def two_values(model, key, schema):
    """Read a field twice, a larger value and a smaller one; nothing if it is no such field."""
    unit = re.search(r'"examples": \["\S+ ([^"]+)"', json.dumps(schema))
    low, high = (f"{n} {unit[1]}" if unit else n for n in ("1", "2"))
    for each in ((low, high), ((low, low), (low, high)), ("1.25", "1.5"), ("0.25", "0.5")):
        try:
            return values_of(model, key, *each)
        except ValidationError:
            continue
    return None


def is_weaker(before, after):
    return any(change.weaker for change in find_changes(before, after))


@pytest.mark.parametrize("model", [*BORNE, *EITHER])
def test_every_value_of_what_must_be_borne_is_weaker_in_a_direction(model):
    """By its value: a part that nobody has thought of here is not passed over."""
    for key, schema in model.model_json_schema()["properties"].items():
        said = None if key in WORDS else two_values(model, key, schema)
        if said is None:
            assert key in WORDS or key in PARTS, key
            continue
        value = getattr(said[1], key)
        wider = isinstance(value, tuple) and model not in (SamplingSpec, SurfaceSpec)
        either = (model in EITHER or isinstance(value, str)) and not wider
        limit = key.startswith("max_") or key == "peak_torque" or model is ScenarioLimitsSpec
        assert is_weaker(*said) is (limit or either), key
        assert is_weaker(*reversed(said)) is (either or not limit), key


@pytest.mark.parametrize(
    "model", [ActuatorSpec, VelocityInterfaceSpec, PositionInterfaceSpec, TorqueInterfaceSpec]
)
def test_a_narrower_range_of_a_drive_is_weaker_and_another_drive_is_not(model):
    for key, field in model.model_fields.items():
        if RANGED & models_in(field.annotation):
            unit = re.search(
                r'"examples": \["\S+ ([^"]+)"',
                json.dumps(model.model_json_schema()["properties"][key]),
            )[1]
            low, middle, high = (f"{n} {unit}" for n in (1, 2, 3))
            wide = {"nominal": middle, "range": (low, high)}
            said = values_of(model, key, wide, wide | {"range": (low, middle)}, low, high)
            assert [is_weaker(said[0], other) for other in said] == [False, True, True, True]
            assert [is_weaker(other, said[0]) for other in said] == [False] * 4
            assert not is_weaker(said[2], said[3])
    said = values_of(model, "dead_time", ("1 ms", "2 ms"), ("1 ms", "1.5 ms"), "1 ms", "3 ms")
    assert [is_weaker(said[0], other) for other in said] == [False, True, True, True]
    assert not is_weaker(said[3], said[2])


@pytest.mark.parametrize(
    "model",
    [ImpedanceControllerSpec, ForceControllerSpec, IntegralControllerSpec, TorqueImpedanceSpec],
)
def test_what_a_controller_touches(model):
    assert is_weaker(*values_of(model, "environment", "soft", "hard"))
    both, one = values_of(model, "contacts", ("soft", "hard"), ("soft",))
    assert is_weaker(both, one)
    assert not is_weaker(one, both)


def models_in(annotation):
    if isinstance(annotation, type) and issubclass(annotation, SpecModel):
        return {annotation}
    return {model for part in get_args(annotation) for model in models_in(part)}


def all_models():
    found, waiting = set(), [InteractionDesignSpec, SwitchedSystemSpec, RobotSpec]
    for model in waiting:
        below = {m for f in model.model_fields.values() for m in models_in(f.annotation)}
        waiting += sorted(below - found - {*waiting}, key=str)
        found |= below | {model}
    return sorted(found - RANGED, key=str)


RANGES = {"wider", "farther", "holding"}


@pytest.mark.parametrize("model", all_models())
def test_every_field_says_which_of_two_values_asks_for_more(model):
    for name, field in model.model_fields.items():
        stronger, _ = declared_in(model)[field.alias or name]
        own = [mark.stronger for mark in field.metadata if isinstance(mark, Declared)]
        below = models_in(field.annotation)
        assert any(own) or model.declared.stronger or below, name
        # A range is more than its ends, and only words are in an order of their own.
        assert stronger in RANGES or not below & RANGED, name
        assert not isinstance(stronger, tuple) or {*stronger} == words_of(field.annotation), name


def words_of(annotation):
    parts = get_args(annotation)
    return {w for part in parts for w in words_of(part)} or {
        None if annotation is NoneType else annotation
    }


def test_the_same_meaning_in_other_words_is_no_change():
    for old, new in (
        ("title: words", "title: 'words' # a comment"),
        (
            "own: {type: force, environment: soft",
            "own: {type: force, environment: soft, contacts: [soft]",
        ),
        ("period: 2 ms", "period: 0.002 s"),
        ("[0.3 ms, 1 ms]", "{range: [0.3 ms, 0.001 s], varies: true}"),
        ("stiffness: 900 N/m", "stiffness: {nominal: 0.9 N/mm, range: [900 N/m, 900.0 N/m]}"),
        (
            "limits: {velocity: 8 deg/s, torque: 0.3 N*m,",
            "limits: {torque: 300 N*mm, velocity: 8 deg/s,",
        ),
    ):
        assert changes(TEXT, edited(TEXT, old, new)) == []


def test_every_part_that_a_shipped_spec_loses_is_weaker_or_beside_the_proof():
    """Whatever is not said any more is weaker, unless it was an assumption or words."""
    for path in sorted((ROOT / "specs").glob("*/*.nrs.yaml")):
        for loaded in read_axes(path):
            spec = loaded.spec
            for key in spec.model_fields_set - {"kind", "controllers", "switching"}:
                found = list(find_changes(spec, spec.model_copy(update={key: None})))
                beside = key in {"title", "mode_logic", "misses"}
                beside |= (key, getattr(spec, key)) == ("contact", "kept")
                assert any(change.weaker for change in found) is not beside, (path, key)


MISSED = edited(
    TEXT, "jitter: 0.1 ms", "jitter: 0.1 ms, misses: {at_most: 2, of: 10, command: hold}"
)
ARM = """\
kind: switched-system
name: c
time: discrete
modes: [{name: hit, A: [[0.5]]}, {name: miss, A: [[1]]}]
switching: arbitrary
misses: {mode: miss, at_most: 2, of: 10}
"""
LIMITS = [
    ("at_most: 2", "at_most: 1", True),
    ("at_most: 2", "at_most: 3", False),
    ("of: 10", "of: 11", True),
    ("of: 10", "of: 9", False),
]


@pytest.mark.parametrize(
    ("text", "old", "new", "weaker"),
    [
        *((text, *limit) for text in (ARM, MISSED) for limit in LIMITS),
        # Steps of a mode are counted only by the rule; what a processor misses must be borne.
        (ARM, "misses: {mode: miss, at_most: 2, of: 10}\n", "", False),
        (MISSED, ", misses: {at_most: 2, of: 10, command: hold}", "", True),
    ],
)
def test_how_often_steps_are_missed(text, old, new, weaker):
    after = edited(text, old, new)
    (change,) = changes(text, after)
    assert change.weaker is weaker
    assert [c.weaker for c in changes(after, text)] == [not weaker]
