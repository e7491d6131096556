"""One period of a sampled loop in floating point, written from the pages of `docs` alone.

Nothing of the package is imported. Every quantity is a row: how it depends on the states before.
"""

from itertools import pairwise

import numpy as np
from scipy.linalg import expm


def single(value):
    return float(np.float32(value))


def step(loop, names, drawn):
    """Return the matrix from the states before a period to those after it.

    `loop` says what the spec says, `drawn` the numbers of this period.
    """
    before = dict(zip(names, np.eye(len(names)), strict=True))
    old = before.get
    none = np.zeros(len(names))
    delta, omega, drive = before["delta"], old("omega", none), loop["drive"]
    damper = old("soft: damper deflection", none)
    force = drawn["k at sample"] * (delta - damper) + drawn["b at sample"] * omega
    forces = [force, *(old(f"F {j} before", none) for j in range(1, loop["delay"][1] + 1))]
    held, turn = old("u 1 before", old("u held", none)), drawn["turn"]
    after, u = _law(loop, before, forces[drawn["age"]], none, drawn["active"])
    commands = [u, *(old(f"u {j} before", none) for j in range(1, drawn["waiting"] + 1))]
    if drawn["missed"]:
        after = {name: old(name, none) for name in after}
        commands[0] = none if loop["misses"] == "zero" else held
    if turn == "motion":
        # The law rests, and no sample of the force comes in.
        after = {n: after[n] if n == "e before" else old(n, none) for n in after}
        forces = forces[1:]
    if turn == "admittance":
        after["e before"], commands[0] = old("e before"), held
    motion, omega, damper = _motion(loop, drawn, commands, (omega, delta, damper))
    shift = motion if drive == "position" else none
    after |= {"delta": delta + motion, "omega": omega, "soft: damper deflection": damper}
    if "e" in after:
        after["e"] = after["e"] - motion
    after["u held"] = commands[0] - shift
    after |= {f"F {j + 1} before": row for j, row in enumerate(forces)}
    after |= {f"u {j + 1} before": row - shift for j, row in enumerate(commands)}
    return np.array([after[name] for name in names])


def _law(loop, before, force, none, active):
    """Return the states of the law after a sample, and the command."""
    T, drive, after = loop["period"], loop["drive"], {}
    outer = T * loop["round"] if loop["turns"] == "motion" else T
    inner = T * loop["round"] if loop["turns"] == "admittance" else T
    law = {name: single(value) for name, value in loop["law"].items()}
    if drive == "torque":
        R = law["R"]
        e = -before["delta"]
        D = single(law["damping"] / T / R)
        u = single(law["stiffness"] / R) * e + D * (e - before["e before"])
        return {"e before": e}, u + single(1 - 1 / R) * force
    p = single(np.exp(-2 * np.pi * loop["cutoff"] * outer)) if loop["lags"] else 0.0
    for j in range(1, loop["lags"] + 1):
        force = p * before[f"filtered {j} before"] + single(1 - p) * force
        after[f"filtered {j} before"] = force
    Mt, Bt, added = law["Mt"], law["Bt"], before.get("integral", none)
    left = single(np.exp(-loop["decay"] * T))
    after["integral"] = left * added
    if active != "a":
        e = added - before["delta"]
        if active == "force":
            e = e - single(loop["force"]) * force
            after["integral"] = added - single(loop["integral"] * T) * force
        after |= {name: left * before.get(name, none) for name in ("vm", "reference")}
        after["e before"] = e
        return after, e if drive == "position" else _motor(law, inner, e, before)
    if drive != "velocity":
        # Beside force controllers the reference is a state, and alone the error of motion.
        e = before["reference"] - before["delta"] if loop["decay"] else before["e"]
        force = force + single(loop["spring"]) * (e + before["delta"])
    else:
        force = force + single(loop["spring"]) * before["delta"]
    a = np.exp(-Bt * outer / Mt) if Mt else 0.0
    vm = single(a) * before.get("vm", none) + single((1 - a) / Bt) * force
    after["vm"] = vm
    if drive == "velocity":
        return after, -vm
    moved = e - single(outer) * (before["vm"] if Mt else vm)
    after |= {"e": moved, "reference": moved + before["delta"]}
    if drive == "position":
        return after, e + added if loop["decay"] else moved
    after["e before"] = e + added
    return after, _motor(law, inner, e + added, before)


def _motor(law, T, e, before):
    """Return the command of the motion controller."""
    D = single(law["Kd"] / T)
    return single(law["Kd"] * law["zero"]) * e + D * (e - before["e before"])


def _motion(loop, drawn, commands, state):
    """Return by how far the joint moves in the period, and its velocity and the damper at the end.

    The deflection is that of the joint and, beside it, of where a position is commanded from.
    """
    drive, length, (omega, delta, damper) = loop["drive"], drawn["length"], state
    begin = np.zeros_like(delta) if drive == "position" else delta
    events = [*drawn["effects"], *(t for t, _ in drawn["loads"])]
    times = sorted({0.0, length, *(t for t in events if 0 < t < length)})
    z = np.array([omega, begin, damper])
    for start, end in pairwise(times):
        # The newest of those that have taken effect.
        u = commands[next(j for j, t in enumerate(drawn["effects"]) if t <= start)]
        k, b, r1, r2 = [numbers for t, numbers in drawn["loads"] if t <= start][-1]
        A, B = np.zeros((3, 3)), np.zeros((3, 2))
        A[:2, :2], B[:2, :1] = _matrices(loop, drawn, (k, b))
        # The spring has the length of what is left of the deflection by the damper.
        A[0, 2] = -A[0, 1] if drive != "position" else 0
        A[2], B[2, 1] = [0, r2, -r1 - r2], r2 * (drive == "position")
        E = expm(np.block([[A, B], [np.zeros((2, 5))]]) * (end - start))
        z = E[:3, :3] @ z + E[:3, 3:] @ np.array([u, delta])
        if drive == "position" and not loop["second"]:
            z[0] = (u - z[1]) / drawn["tau"]
    return z[1] - begin, z[0], z[2]


def _matrices(loop, drawn, load):
    """Return A and B of (velocity, position)."""
    drive, against = loop["drive"], loop["load"]
    if loop["second"]:
        a1, a0 = loop["second"]
        return np.array([[-a1, -a0], [1, 0]]), np.array([[a0], [0]])
    if drive == "torque":
        J, (k, b) = drawn["inertia"], load
        return np.array([[-(drawn["friction"] + b) / J, -k / J], [1, 0]]), np.array([[1 / J], [0]])
    tau = drawn["tau"]
    if drive == "position":
        return np.array([[0, 0], [0, -1 / tau]]), np.array([[0], [1 / tau]])
    k, b = [x / against if against else 0.0 for x in load]
    return np.array([[-1 / tau - b, -k], [1, 0]]), np.array([[drawn["gain"] / tau], [0]])


def draw(loop, rng, contact):
    """Return admissible numbers of one period: ends of ranges, or values inside."""

    def one(low, high):
        return float([low, high, rng.uniform(low, high)][rng.integers(3)])

    def any_of(name):
        return one(*loop.get(name, (1, 1)))

    T, jitter, (least, most) = loop["period"], loop["jitter"], loop["wait"]
    waiting = int(np.ceil(most / (T - jitter) - 1e-9))
    starts = [0.0, *-np.cumsum([one(T - jitter, T + jitter) for _ in range(waiting)])]
    drawn = {n: any_of(n) for n in ("tau", "gain", "inertia", "friction")}
    drawn |= {"length": one(T - jitter, T + jitter), "waiting": waiting}
    # The oldest has taken effect when the period begins, whatever the rest do.
    drawn["effects"] = [s + one(least, most) for s in starts[:-1] or starts]
    drawn["effects"] += [-np.inf] if waiting else []
    drawn["missed"] = bool(loop["misses"]) and rng.random() < 0.5
    any_one = ["a", "force"] if loop["decay"] else ["force"] if loop["force"] else ["a"]
    drawn["active"] = str(rng.choice(any_one + ["position"] * (loop["integral"] > 0)))
    drawn["turn"] = str(rng.choice(["both", loop["turns"]])) if loop["turns"] else "both"
    drawn["age"] = int(rng.integers(loop["delay"][0], loop["delay"][1] + 1))

    def touched(lost):
        """Return stiffness and damping, and the rates of what remembers."""
        k, b, creep = any_of("k"), one(*loop["b"]), loop["creep"]
        if not creep:
            return (0.0, 0.0, 0.0, 0.0) if lost else (k, b, 0.0, 0.0)
        k1, damper = one(*creep[0]), one(*creep[1])
        return k, 0.0, k1 / damper, k / damper

    first = touched(not contact)
    drawn["k at sample"], drawn["b at sample"], *_ = first
    loads = [(0.0, first)]
    for t in sorted(rng.uniform(0, drawn["length"], rng.integers(3))):
        loads.append((t, touched(loop["losable"] and rng.random() < 0.5)))
    return drawn | {"loads": loads}
