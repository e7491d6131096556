"""A PI force controller in the sampled loop: its map, its roundings, and what is proved of them."""

import numpy as np
import pytest

from tests.loop.support import assembled
from tests.simulation.interactions import FORCE, INSERTION, POSITION, simulated, text_of

PI = "{type: pi-force, environment: soft, proportional_gain: 0.02 rad/(N*m), "
PI += "integral_gain: 0.5 rad/(N*m*s)}"
BOTH = {"position": POSITION, "force": PI}
SAMPLED = "idle_states: {decay: 20 1/s}\nsampling: {period: 2 ms, delay: 1}\ncontact: kept\n"
KM, TAU, T, K = 4.8417e-4, 0.0351, 2e-3, 43.0
single = np.float32


@pytest.mark.parametrize("controller", ["position", "force", "insertion", "hold"])
def test_a_period_is_that_of_processor_and_motor(controller):
    """The law as its lines in `controllers.step_law` have it, in doubles, and the motor exactly."""
    system = assembled(text_of(BOTH | {"insertion": INSERTION, "hold": FORCE}, more=SAMPLED))
    names = [state.split(" [")[0] for state in system.states]
    assert names == ["reference", "omega", "e before", "vm", "integral", "F 1 before", "delta"]
    Kp, D = float(single(2060 * 56.9706)), float(single(2060 / T))
    Kf, Ki_T = float(single(0.02)), float(single(0.5 * T))
    a = float(single(np.exp(-2.15 * T / 0.01)))
    b, left = float(single((1 - a) / 2.15)), float(single(np.exp(-20 * T)))
    x = dict(zip(names, np.random.default_rng(5).normal(size=7), strict=True))
    force = x["F 1 before"]
    taken = {"position": 0.0, "insertion": x["reference"]}.get(controller, -Kf * force)
    e = taken + x["integral"] - x["delta"]
    u = Kp * e + D * (e - x["e before"])
    E = np.exp(-T / TAU)
    s = TAU * (1 - E)
    moves = controller == "insertion"
    wanted = {
        "reference": x["reference"] - T * x["vm"] if moves else left * x["reference"],
        "omega": E * x["omega"] + KM * (1 - E) * u,
        "e before": e,
        "vm": a * x["vm"] + b * force if moves else left * x["vm"],
        "integral": x["integral"] - Ki_T * force if controller == "force" else left * x["integral"],
        "F 1 before": K * x["delta"],
        "delta": x["delta"] + s * x["omega"] + KM * (T - s) * u,
    }
    found = [mode for mode in system.modes if mode.name.startswith(f"{controller}/soft")]
    assert found
    for mode in found:
        A = np.array(mode.A.numerators, float) / mode.A.denominator
        # a is rounded from the gains that ship, Mt and Bt.
        after = A @ [x[name] for name in names]
        assert after == pytest.approx([wanted[name] for name in names], rel=2e-6, abs=1e-6)


def test_the_run_in_single_precision_leaves_no_error():
    """What rounding leaves of the error is below what a sample adds to the integral."""
    text = text_of(
        BOTH,
        scenario="command: {points: [[0 s, 4 deg/s], [3 s, 4 deg/s]]}, "
        "surfaces: [{environment: soft, at: 2 deg}], "
        "control: {threshold: {position: position, force: force, torque: 0.27 N*m}}",
        more=SAMPLED,
    )
    run = simulated(text, engine="sampled")
    assert run.response["torque"][-1] == pytest.approx(0.3, abs=2e-6)
