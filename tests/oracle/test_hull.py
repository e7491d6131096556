"""The map of a period at admissible numbers lies between the modes of the package."""

import contextlib
from itertools import islice

import numpy as np
import pytest

from nrs_design.errors import NrsDesignError
from tests.loop.support import assembled, outside
from tests.oracle.plant import draw, step
from tests.tables import entry

# Shares of an entry: what single precision and enclosures are off, and what an error makes.
CLOSE, SEEN = 1e-6, 1e-4
HEAD = """kind: interaction-design
name: drawn
title: Drawn
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
switching: arbitrary
"""


def written(pair, unit):
    low, high = pair
    middle = f"{float(f'{(low + high) / 2:.6g}')!r} {unit}"
    return (
        middle
        if low == high
        else f"{{nominal: {middle}, range: [{low!r} {unit}, {high!r} {unit}]}}"
    )


# What a sample may compute beside both: with an outer period that is shorter, and longer.
OTHER_TURNS = ("admittance", "motion")


def drives(loop):
    law, tau = loop["law"], written(loop.get("tau", (1, 1)), "s")
    if loop["drive"] == "torque":
        J, b = written(loop["inertia"], "kg*m^2"), written(loop["friction"], "N*m*s/rad")
        return f"torque_interface: {{inertia: {J}, friction: {b}}}"
    if loop["drive"] != "actuator":
        if loop["second"]:
            a1, a0 = loop["second"]
            made = f"numerator: [{a0}], denominator: [1, {a1}, {a0}]"
            return f"position_interface: {{transfer_function: {{{made}}}}}"
        dead = f", dead_time: {loop['dead']!r} s" * bool(loop["dead"])
        return f"{loop['drive']}_interface: {{time_constant: {tau}{dead}}}"
    motion = f"derivative_gain: {law['Kd']!r} rpm*s/rad, zero: {law['zero']!r} 1/s"
    settling = f"damping_ratio: 0.707, settling_time: {2 * sum(loop['tau']):.6g} s"
    gain = written(loop["gain"], "rad/s/rpm")
    load = f", load_inertia: {loop['load']!r} kg*m^2" * bool(loop["load"])
    return f"""actuator: {{gain: {gain}, time_constant: {tau}{load}}}
motion_loop: {{{settling}, {motion}}}"""


def span(low, high, unit=""):
    return f"{low!r}{unit}" if low == high else f"[{low!r}{unit}, {high!r}{unit}]"


def spec_of(loop):
    """Return the text of a spec."""
    law, T = loop["law"], loop["period"]
    inner, outer = (T * (loop["round"] if loop["turns"] == t else 1) for t in OTHER_TURNS)
    keys = f"period: {inner:.9g} s, delay: {span(*loop['delay'])}"
    keys += f", outer_period: {outer:.9g} s" * bool(loop["turns"])
    keys += f", jitter: {loop['jitter']!r} s" * bool(loop["jitter"])
    late = [float(f"{wait - loop['dead']:.9g}") for wait in loop["wait"]]
    keys += f", latency: {span(*late, ' s')}" * bool(late[1])
    keys += f", misses: {{consecutive: 1, command: {loop['misses']}}}" * bool(loop["misses"])
    damped = bool(loop["b"][1])
    stiffness = written(loop["k"], "N*m/rad")
    tissue = f"model: {'kelvin-voigt' if damped else 'elastic'}, stiffness: {stiffness}"
    tissue += f", damping: {written(loop['b'], 'N*m*s/rad')}" * damped
    if loop["creep"]:
        behind, damper = (written(c, "N*m/rad" + "*s" * i) for i, c in enumerate(loop["creep"]))
        tissue = f"model: kelvin-boltzmann, parallel_stiffness: {behind}"
        tissue += f", series_stiffness: {stiffness}, damping: {damper}"
    if loop["drive"] == "torque":
        gains = f"torque-impedance, stiffness: {law['stiffness']!r} N*m/rad"
        gains += f", damping: {law['damping']!r} N*m*s/rad"
        gains += f", inertia_ratio: {law['R']!r}" * (law["R"] != 1)
    else:
        gains = f"impedance, Mt: {law['Mt']!r} kg*m^2, Bt: {law['Bt']!r} N*m*s/rad"
        gains += f", Kt: {loop['spring']!r} N*m/rad" * bool(loop["spring"])
    each = f"  a: {{type: {gains}, environment: soft}}\n" * (loop["decay"] > 0 or not loop["force"])
    gain = f"force, proportional_gain: {loop['force']!r} rad/(N*m), environment: soft"
    if loop["integral"]:
        gain = f"pi-{gain}, integral_gain: {loop['integral']!r} rad/(N*m*s)"
        each += "  position: {type: position}\n"
    each += f"  force: {{type: {gain}}}\n" * bool(loop["force"])
    each += f"idle_states: {{decay: {loop['decay']!r} 1/s}}\n" * bool(loop["decay"])
    sensor = f"sensor: {{filter: {{order: {loop['lags']}, cutoff: {loop['cutoff']!r} Hz}}}}\n"
    return f"""{HEAD}{drives(loop)}
{sensor * bool(loop["lags"])}environments: {{soft: {{{tissue}}}}}
controllers:
{each}sampling: {{{keys}}}
contact: {"losable" if loop["losable"] else "kept"}
"""


def some_loop(rng):
    """Return a loop with a few of the features that a spec may have, and up to two ranges."""
    drive = str(rng.choice(["actuator", "velocity", "position", "torque"]))
    torque, damped = drive == "torque", bool(rng.random() < 0.4)
    own = {"actuator": ["tau", "gain"], "torque": ["inertia", "friction"]}.get(drive, ["tau"])
    can = [*own, "k", "wait", "jitter", "delay", "k1", "damper", *["b"] * damped]
    wide = set(rng.choice(can, min(len(can), int(rng.integers(1, 3))), replace=False))

    def some(share):
        return bool(rng.random() < share)

    def size(low, high):
        return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.3g}")

    def around(name, low, high, ratio):
        first = size(low, high)
        return (first, float(f"{first * rng.uniform(1, ratio):.3g}") if name in wide else first)

    T = size(0.001, 0.01)
    longest = size(0.05 * T, 2 * T) if "wait" in wide or some(0.3) else 0.0
    gains = {"stiffness": size(5, 100), "damping": size(1, 5), "R": [1, 0.7, 1.5][rng.integers(3)]}
    law = {"Mt": size(1e-4, 0.1) * some(0.7), "Bt": size(0.5, 5), "Kd": 2060.0, "zero": 56.9706}
    oldest, lags = int(rng.integers("delay" in wide, 3)), max(0, int(rng.integers(-3, 3)))
    # These would have thousands of modes.
    if drive == "position" and "jitter" in wide:
        longest = min(longest, float(f"{0.4 * T:.3g}"))
    misses = "" if some(0.6) else str(rng.choice(["hold", "zero"]))
    motor = drive == "actuator"
    moved = drive in ("actuator", "position")
    load, force = size(0.01, 1) * (motor and some(0.5)), size(0.001, 0.1) * (moved and some(0.3))
    decay = size(1, 100) if force and some(0.5) else 0.0
    spring = size(1, 100) * (not torque and some(0.3))
    turns = str(rng.choice(OTHER_TURNS)) if motor and not force and some(0.3) else ""
    if turns:
        misses = ""
    losable = (
        some(0.3)
        and (not load or spring > 0 or force > 0)
        and not ((decay and not spring) or (torque and (damped or len(wide) > 1)))
    )
    creep = (around("k1", 5, 50, 2), around("damper", 0.5, 10, 2)) if some(0.3) else ()
    dead = longest / 3 * (drive in ("velocity", "position") and "wait" not in wide)
    if losable or damped or len(wide) > 1 + (not load and not torque):
        creep = ()
    integral = size(0.1, 1) * (decay > 0 and not losable and not creep and some(0.5))
    return {
        "drive": drive, "law": gains if torque else law, "period": T,
        "wait": (size(longest / 9, longest) if "wait" in wide else longest, longest),
        "jitter": size(0.02 * T, 0.45 * T) if "jitter" in wide else 0.0,
        "delay": (0 if "delay" in wide else oldest, oldest),
        "lags": 0 if torque else lags, "cutoff": size(20, 200),
        "misses": "hold" if misses and drive == "position" else misses,
        "tau": around("tau", 0.001, 0.05, 4),
        "gain": around("gain", 4e-4, 5e-4, 1.2) if drive == "actuator" else (1.0, 1.0),
        "inertia": around("inertia", 0.1, 0.5, 3), "friction": around("friction", 0.2, 1, 2),
        "k": around("k", 10, 200, 3), "b": around("b", 0.1, 2, 3) if damped else (0.0, 0.0),
        "losable": losable, "creep": creep,
        "load": load, "force": force, "decay": decay, "integral": integral,
        "spring": spring, "dead": dead, "second": (),
        "turns": turns, "round": int(rng.integers(2, 4)),
    }  # fmt: skip


def chosen(system, drawn, contact):
    """Return the modes of this controller, contact and age."""
    modes = system.modes if contact or not system.free else system.free
    first, age = "miss/" if drawn["missed"] else f"{drawn['active']}/", f"/delay-{drawn['age']}/"
    first = "motion" if drawn["turn"] == "motion" else first
    modes = [mode for mode in modes if mode.name.startswith(first)]
    alone = drawn["turn"] == "admittance"
    modes = [mode for mode in modes if ("/admittance" in mode.name) is alone]
    aged = any("/delay-" in mode.name for mode in modes)
    return [np.array(m.A.floats()) for m in modes if not aged or age in m.name + "/"]


def beside(matrices, found):
    """Return how far a matrix is from the hull of others, in shares of the size of each entry."""
    modes = np.array([A.ravel() for A in matrices]).T
    size = np.maximum(np.abs(modes).max(axis=1), np.abs(found.ravel()))
    size = np.maximum(size, 1e-12 * size.max())
    return outside(modes / size[:, None], found.ravel() / size)


def moving(names, matrices):
    """Return which states move the joint, sooner or later; a force that nothing reads does not."""
    reads = np.any(matrices, axis=0)
    read = np.array([name == "delta" for name in names])
    for _ in names:
        read = read | reads[read].any(axis=0)
    return read


def assert_between(loop, system, rng):
    """Draw maps, each of which must lie in the hull of the modes."""
    names = [name.partition(" [")[0] for name in system.states]
    for _ in range(5):
        contact = not (loop["losable"] and rng.random() < 0.3)
        drawn = draw(loop, rng, contact)
        found = step(loop, names, drawn)
        read = moving(names, [found, *(np.array(mode.A.floats()) for mode in system.modes)])
        far = beside([A[read] for A in chosen(system, drawn, contact)], found[read])
        assert far <= CLOSE, (spec_of(loop), contact, drawn)


def plain(drive):
    """Return a loop without ranges, every number of which counts."""
    law = {"stiffness": 20.0, "damping": 2.0, "R": 0.7}
    motor, mixed = drive.split(",")[0] in ("actuator", "loaded", "mixed"), "mixed" in drive
    if drive != "torque":
        law = {"Mt": 0.01, "Bt": 2.0, "Kd": 2060.0, "zero": 56.9706}
    return {
        "drive": "actuator" if motor else drive.partition(",")[0], "law": law,
        "period": 0.002, "jitter": 0.0, "wait": (0.0007, 0.0007),
        "delay": (1, 1), "lags": int(drive != "torque"), "cutoff": 60.0, "misses": "",
        "tau": (0.01, 0.01), "gain": (4.8e-4, 4.8e-4) if motor else (1.0, 1.0),
        "inertia": (0.2, 0.2), "friction": (0.5, 0.5), "k": (80.0, 80.0), "b": (0.5, 0.5),
        "losable": False, "load": 0.3 if "loaded" in drive else 0.0,
        "creep": ((30.0, 30.0), (3.0, 3.0)) if "creeping" in drive else (),
        "force": 0.02 * mixed, "decay": 20.0 * mixed, "integral": 0.5 * ("integral" in drive),
        "spring": 30.0 * (drive == "actuator" or "sprung" in drive), "dead": 0.0,
        "second": (60.0, 900.0) if "second" in drive else (),
        "turns": "", "round": 1,
    }  # fmt: skip


SLOW = pytest.param(range(6, 40), marks=pytest.mark.slow)
NIGHTLY = pytest.param(range(40, 300), marks=pytest.mark.nightly)


@pytest.mark.parametrize("seeds", [range(6), SLOW, NIGHTLY], ids=str)
def test_maps_of_drawn_loops_lie_between_the_modes(seeds):
    accepted = 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        loop = some_loop(rng)
        with contextlib.suppress(NrsDesignError):
            system = assembled(spec_of(loop))
            accepted += 1
            assert_between(loop, system, rng)
    assert accepted >= len(seeds) / 2


# Features that act on each other within a period.
TOGETHER = entry(__file__, "together")


@pytest.mark.parametrize("name", TOGETHER)
def test_maps_of_what_stands_together_lie_between_the_modes(name):
    def has_all(loop):
        drive = loop["drive"]
        loop = loop | {"placed": drive == "position", "streamed": drive == "velocity"}
        return all(loop[key] for key in TOGETHER[name])

    loops = ((seed, some_loop(np.random.default_rng(seed))) for seed in range(100_000))
    few = [*islice((item for item in loops if has_all(item[1])), 3)]
    assert len(few) == 3
    for seed, loop in few:
        assert_between(loop, assembled(spec_of(loop)), np.random.default_rng(seed))


@pytest.mark.parametrize("Mt", [0.01, 0.0])
@pytest.mark.parametrize("late", [0.0003, 0.001, 0.002, 0.0027, 0.005])
@pytest.mark.parametrize("drive", ["actuator", "velocity", "position", "position, second"])
def test_maps_of_commands_that_are_late_lie_between_the_modes(drive, late, Mt):
    """Within a period, by whole periods, and by more; of a robot, its dead time is a part of it."""
    loop = plain(drive) | {
        "wait": (late, late),
        "dead": late / 2 * (drive in ("velocity", "position")),
    }
    loop["law"] = loop["law"] | {"Mt": Mt}
    assert_between(loop, assembled(spec_of(loop)), np.random.default_rng(0))


OF_DRIVE = {"actuator": ["Mt", "Bt", "Kd", "zero", "tau", "gain", "spring"]}
OF_DRIVE["loaded"] = [*OF_DRIVE["actuator"][:-1], "load", "loads"]
OF_DRIVE["position, sprung"] = OF_DRIVE["velocity, sprung"] = ["Mt", "Bt", "tau", "spring"]
OF_DRIVE["position, second"] = ["Mt", "Bt", "second"]
OF_DRIVE["position, mixed"] = ["force", "decay", "tau"]
OF_DRIVE["mixed"] = ["force", "decay", "Kd", "zero"]
OF_DRIVE["mixed, integral"] = ["force", "integral"]
OF_DRIVE["actuator, creeping"] = OF_DRIVE["loaded, creeping"] = ["Bt", "tau", "rates", "follows"]
OF_DRIVE["position, creeping"] = ["Bt", "tau", "rates", "follows"]
# Stiffness, damping and rates of what is touched within a period.
LOADS = {"loads": (81.6, 0.5, 0, 0), "rates": (80, 0, 10.2, 80 / 3), "follows": (80, 0, 10, 27.2)}
OF_DRIVE["torque"] = ["stiffness", "damping", "R", "inertia", "friction", "loads"]


@pytest.mark.parametrize("drive", [*OF_DRIVE, "velocity", "position"])
def test_an_error_of_two_percent_is_seen(drive):
    loop, rng = plain(drive), np.random.default_rng(0)
    active = {"active": "force" if "mixed" in drive else "a"}
    system, right = assembled(spec_of(loop)), draw(loop, rng, True) | active
    names = [name.partition(" [")[0] for name in system.states]
    modes, law = chosen(system, right, True), loop["law"]

    def far(law=law, **other):
        return beside(modes, step(loop | {"law": law} | other, names, right | other))

    assert far() <= CLOSE
    for name in OF_DRIVE.get(drive, ["Mt", "Bt", "tau"]):
        wrong = {name: 1.02 * law[name]} if name in law else {}
        load = name in LOADS
        if name == "second":
            assert far(second=(61.2, 900.0)) > SEEN < far(second=(60.0, 918.0))
            continue
        other = (
            {"loads": [(0.0, LOADS[name])]} if load else {name: 1.02 * (loop | right).get(name, 0)}
        )
        assert far(law | wrong, **({} if wrong else other)) > SEEN, name
    late = {"effects": [right["effects"][0] + 1e-4, *right["effects"][1:]]}
    wrongs = [late, {"length": right["length"] + 1e-4}, {"age": 0}, {"k at sample": -80.0}]
    wrongs += [{"k at sample": 81.6}, {"b at sample": 1.0}]
    for wrong in [*wrongs, *[{"cutoff": 61.2}] * loop["lags"]]:
        assert far(**wrong) > SEEN, wrong
