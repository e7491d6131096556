"""What combines in one spec, as it is read: a table of pairs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from itertools import combinations
from typing import Any

from nrs_design.errors import SpecError
from nrs_design.spec import doubt_spec, parse_spec

Tree = dict[str, Any]

# What a doubt about a spec says that `certify-switching` will not take.
_NOT_TAKEN = "so certify-switching refuses this spec"
# What cannot be in one proof, though each half can: the answer is a list of what is proved.
_LISTED = {
    ("two periods", "axes that act on each other"),
    ("two periods", "velocity command"),
    ("two periods", "errors of the sensors"),
}
_IMPEDANCE = {
    "type": "impedance",
    "environment": "soft",
    "Mt": "0.01 kg*m^2",
    "Bt": "2.15 N*m*s/rad",
}
_FORCE = {"type": "force", "environment": "soft", "proportional_gain": "0.02 rad/(N*m)"}
_PI = _FORCE | {"type": "pi-force", "integral_gain": "0.5 rad/(N*m*s)"}
_PARALLEL = _FORCE | {"type": "parallel", "integral_gain": "0.2 rad/(N*m*s)"}
_PLACED = {"type": "position"}
_ELASTIC = {"model": "elastic", "stiffness": "43 N*m/rad"}
_IDLE: Tree = {"idle_states": {"decay": "20 1/s"}}
_SAMPLING = {"period": "2 ms", "delay": 0}
_BASE: Tree = {
    "kind": "interaction-design",
    "name": "combined",
    "actuator": {"gain": "4.8417e-4 rad/s/rpm", "time_constant": "0.0351 s"},
    "motion_loop": {
        "damping_ratio": 0.707,
        "settling_time": "0.1404 s",
        "derivative_gain": "2060 rpm*s/rad",
        "zero": "56.9706 1/s",
    },
    "limits": {"velocity": "8 deg/s", "torque": "0.3 N*m", "bandwidth": "2 Hz"},
    "environments": {"soft": _ELASTIC},
    "controllers": {"first": _IMPEDANCE, "second": _IMPEDANCE | {"Bt": "4 N*m*s/rad"}},
    "contact": "kept",
    "switching": "arbitrary",
}


@dataclass(frozen=True)
class Feature:
    """One thing that a spec may have besides the plainest, and what it changes.

    Parameters
    ----------
    name : str
        In the table.
    key : str
        Where a spec says it.
    changes : mapping
        Merged into the spec.
    replaces : str
        Two that replace the same part cannot be in one spec.
    """

    name: str
    key: str
    changes: Mapping[str, Any]
    replaces: str = ""


def _laws(first: Tree, second: Tree, **beside: Any) -> Tree:
    return {"controllers": {"first": first, "second": second}, **beside}


FEATURES = (
    Feature("sampling", "sampling", {"sampling": _SAMPLING}),
    Feature("varying delay", "sampling.delay", {"sampling": _SAMPLING | {"delay": [0, 2]}}),
    Feature(
        "two periods",
        "sampling.outer_period",
        {"sampling": _SAMPLING | {"outer_period": "4 ms"}},
    ),
    Feature("contact that is lost", "contact", {"contact": "losable"}),
    Feature(
        "damped tissue",
        "environments: kelvin-voigt",
        {"environments": {"soft": {"model": "kelvin-voigt", "damping": "1 N*m*s/rad"}}},
        "tissue",
    ),
    Feature(
        "tissue that remembers",
        "environments: maxwell, kelvin-boltzmann",
        {"environments": {"soft": {"model": "maxwell", "damping": "10 N*m*s/rad"}}},
        "tissue",
    ),
    Feature(
        "hand with a mass",
        "environments: hand",
        {
            "environments": {
                "soft": {"model": "hand", "damping": "7 N*m*s/rad", "mass": "0.1 kg*m^2"}
            }
        },
        "tissue",
    ),
    Feature(
        "two contacts at once",
        "controllers: contacts",
        {"environments": {"stiff": _ELASTIC}},
        "contacts",
    ),
    Feature(
        "range of the tissue",
        "environments: range",
        {
            "environments": {
                "soft": {"stiffness": {"nominal": "43 N*m/rad", "range": "RANGE 40 46 N*m/rad"}}
            }
        },
    ),
    Feature(
        "range of the motor",
        "actuator: range",
        {
            "actuator": {
                "gain": {
                    "nominal": "4.8417e-4 rad/s/rpm",
                    "range": "RANGE 4.8e-4 4.9e-4 rad/s/rpm",
                }
            }
        },
    ),
    Feature(
        "tissue loads the motor",
        "actuator.load_inertia",
        {"actuator": {"load_inertia": "1.213 kg*m^2"}},
    ),
    Feature(
        "axes that act on each other",
        "coupling",
        {
            "actuator": {"load_inertia": "1.213 kg*m^2"},
            "coupling": {"inertia": ["0 kg*m^2", "0.1 kg*m^2"], "axes": 3},
        },
    ),
    Feature("velocity command", "disturbances.command", {"disturbances": {"command": "8 deg/s"}}),
    Feature(
        "errors of the sensors",
        "disturbances: the others",
        {
            "sampling": _SAMPLING,
            "disturbances": {
                "friction": "50 rpm",
                "encoder_step": "0.01 deg",
                "force_step": "0.01 N*m",
                "largest_angle": "20 deg",
            },
        },
    ),
    Feature(
        "constant force settles",
        "goals.constant_force",
        {"goals": {"constant_force": "settles"}, "contact": "losable"},
    ),
    Feature(
        "decay although signals saturate",
        "goals.initial_force",
        {"limits": {"command": "2000 rpm"}, "goals": {"initial_force": "0.1 N*m"}},
    ),
    Feature(
        "gains in a range",
        "controllers: range",
        {
            "controllers": {
                "first": {"Bt": {"nominal": "2.15 N*m*s/rad", "range": "RANGE 2 2.3 N*m*s/rad"}}
            }
        },
        "law",
    ),
    Feature(
        "spring Kt",
        "controllers: Kt",
        {"controllers": {name: {"Kt": "0.5 N*m/rad"} for name in ("first", "second")}},
        "law",
    ),
    Feature("force beside position", "controllers: force, position", _laws(_PLACED, _FORCE), "law"),
    Feature(
        "PI force beside position", "controllers: pi-force", _laws(_PLACED, _PI, **_IDLE), "law"
    ),
    Feature(
        "offset X_i",
        "controllers: offset",
        _laws(_PLACED, _FORCE | {"offset": "measured"}),
        "law",
    ),
    Feature(
        "all kinds of controllers",
        "idle_states",
        {
            "controllers": {"first": _PLACED, "second": _IMPEDANCE, "third": _FORCE},
            **_IDLE,
        },
        "law",
    ),
    Feature("parallel control", "controllers: parallel", _laws(_PARALLEL, _PARALLEL), "law"),
    Feature("dwell times", "switching.dwell_time", {"switching": {"dwell_time": "1 s"}}, "rules"),
    Feature(
        "allowed transitions",
        "switching.transitions",
        {"switching": {"transitions": [["first", "second"]]}},
        "rules",
    ),
)


def _merged(tree: Any, changes: Any) -> Any:
    if not (isinstance(tree, dict) and isinstance(changes, Mapping)):
        return changes
    return tree | {key: _merged(tree.get(key), value) for key, value in changes.items()}


def _text(tree: Tree) -> str:
    """Write a spec: JSON is YAML; a range is a list of two."""

    def written(item: Any) -> Any:
        if isinstance(item, dict):
            return {key: written(value) for key, value in item.items()}
        if isinstance(item, str) and item.startswith("RANGE "):
            _, low, high, unit = item.split()
            return [f"{low} {unit}", f"{high} {unit}"]
        return item

    return json.dumps(written(tree), indent=1)


def spec_of(*features: Feature) -> str:
    """Return the text of a spec that has some features, and nothing else that is not needed.

    Parameters
    ----------
    features : Feature
        What it has.
    """
    tree = _BASE
    laws = [item for item in features if "type" in str(item.changes.get("controllers"))]
    if laws:
        tree = tree | {"controllers": {}}
    for item in (*laws, *features):
        tree = _merged(tree, item.changes)
    if any(item.replaces == "contacts" for item in features):
        touching = {"contacts": [["soft", "stiff"]]}
        tree = tree | {
            "controllers": {
                name: law | (touching if "environment" in law else {})
                for name, law in tree["controllers"].items()
            }
        }
    return _text(tree)


class Answer(Enum):
    """What a spec with two features comes to."""

    TOGETHER = "one certificate"
    LISTED = "a list of what is proved"
    REFUSED = "refused"
    ALTERNATIVES = "never both"


@dataclass(frozen=True)
class Pair:
    """Two features, what comes of them, and why."""

    features: tuple[Feature, Feature]
    answer: Answer
    why: str = ""
    remedy: str = ""


def pairs() -> list[Pair]:
    """Read a spec for every pair of features."""
    return [pair_of(a, b) for a, b in combinations(FEATURES, 2)]


def pair_of(a: Feature, b: Feature) -> Pair:
    """Read a spec with two features.

    Parameters
    ----------
    a, b : Feature
        In the order of the table.
    """
    if a.replaces and a.replaces == b.replaces:
        return Pair((a, b), Answer.ALTERNATIVES)
    try:
        spec = parse_spec(spec_of(a, b))
    except SpecError as error:
        first = error.faults[0]
        why = first.message.partition(": ")[2] or first.message
        return Pair((a, b), Answer.REFUSED, why, first.remedy or "")
    for doubt in doubt_spec(spec):
        if _NOT_TAKEN in doubt.message:
            why, _, remedy = doubt.message.partition(f", {_NOT_TAKEN}")
            return Pair((a, b), Answer.REFUSED, why, remedy.strip(" ()"))
    listed = (a.name, b.name) in _LISTED
    return Pair((a, b), Answer.LISTED if listed else Answer.TOGETHER)
