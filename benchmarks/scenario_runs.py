"""A minute of switching in tissue: events against an integrator; and the sampled law against time.

The peer is SciPy's `solve_ivp` as a user would write it: each stay at a relative tolerance of 1e-9,
contact as an event that ends it. Both are held against the same integrator at 1e-13.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.measure import Comparison, Finding, Size, least_side_by_side
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.laws import Admittance
from nrs_design.models.plant import Plant
from nrs_design.pipeline.runs import run_design
from nrs_design.simulation.build_scenario import default_scenario
from nrs_design.simulation.exact import simulate_exactly
from nrs_design.simulation.sampled import simulate_sampled
from nrs_design.simulation.scenario import Array, Control, Profile, Scenario
from nrs_design.spec import InteractionDesignSpec, read_spec

SPEC = Path(__file__).parents[1] / "specs/neuroboscope/soft-tissue-sampled.nrs.yaml"
SECONDS, SWITCHES = 60.0, 1000
TARGET, REAL_TIME = 20.0, 100.0
# In rad/s and rad/s: the hand swings so, and the surface is so far away, in rad.
SWING, OMEGA, SURFACE = 0.1, 1.7, 0.01


def run(size: Size) -> tuple[Comparison | Finding, ...]:
    """Measure both engines."""
    designed = run_design(read_spec(SPEC))
    assert designed is not None
    given = designed.spec, designed.plant, designed.design
    length = size.pick(SECONDS, SECONDS, 1.0)
    exact, sampled = _scenario(*given[:2], length), default_scenario(*given[:2])
    peer = _Peer(designed.plant, designed.design, exact)
    simulate_exactly(*given, replace(exact, duration=min(length, 1.0)))  # Loads SciPy.
    (theirs, ours), (end, found) = least_side_by_side(
        size.pick(7, 2, 1), lambda: peer.end(1e-9), lambda: simulate_exactly(*given, exact)
    )
    truth = peer.end(1e-13)
    response = found.response
    own = np.array([response["angle"][-1], response["velocity"][-1]])
    errors = [float(np.abs(each[[3, 1]] - truth[[3, 1]]).max()) for each in (end,)]
    errors.append(float(np.abs(own - truth[[3, 1]]).max()))
    note = f"least processor time of several pairs; {len(found.switches)} switches, "
    note += f"{len(found.contacts)} changes of contact; error at "
    note += f"the end in rad and rad/s: peer {errors[0]:.1e}, ours {errors[1]:.1e}"
    work = f"{length:.0f} s of the switched loop in tissue"
    long = replace(sampled, profile=exact.profile, duration=size.pick(20.0, 20.0, 0.5))
    start = process_time()
    simulate_sampled(*given, long)
    seconds = process_time() - start
    share = long.duration / seconds
    return (
        Comparison(work, "solve_ivp, DOP853, rtol 1e-9", theirs, ours, TARGET, note),
        Finding(
            "one axis, the law in single precision, 2 ms",
            f"{share:.0f} times real time, by processor time",
            f"{REAL_TIME:.0f} times",
            share >= REAL_TIME,
            seconds,
        ),
    )


def _scenario(spec: InteractionDesignSpec, plant: Plant, length: float) -> Scenario:
    usual = default_scenario(spec, plant)
    times = length * np.arange(1, SWITCHES + 1) / (SWITCHES + 1)
    names = ("withdrawal", "insertion")
    schedule = tuple((float(t), names[i % 2]) for i, t in enumerate(times))
    return replace(
        usual,
        profile=Profile.sinusoid(SWING, OMEGA),
        duration=length,
        control=Control("insertion", schedule=schedule),
        surfaces=tuple(replace(s, at=SURFACE) for s in usual.surfaces),
    )


class _Peer:
    """The loop as it stands in the thesis: error, velocity, admittance, angle."""

    def __init__(self, plant: Plant, design: ControllerDesign, scenario: Scenario) -> None:
        self.scenario = scenario
        self.Km, self.tau = float(plant.actuator.gain), float(plant.actuator.time_constant)
        self.Kp, self.Kd = float(design.motion.Kp), float(design.motion.Kd)
        self.laws = {c.name: c.law for c in design.controllers}
        (surface,) = scenario.surfaces
        assert surface.element is not None
        self.k = surface.element.k

    def end(self, rtol: float) -> Array:
        """Return the state at the end."""
        y, touching, t = np.zeros(4), False, 0.0
        stays = [(0.0, self.scenario.control.start), *self.scenario.control.schedule]
        ends = [time for time, _ in stays[1:]] + [self.scenario.duration]
        for (_, name), end in zip(stays, ends, strict=True):
            while t < end:
                found = solve_ivp(
                    self._rates(name, touching), (t, end), y, "DOP853",
                    rtol=rtol, atol=1e-3 * rtol, events=self._surface(touching),
                )  # fmt: skip
                t, y = float(found.t[-1]), found.y[:, -1]
                touching = touching != bool(len(found.t_events[0]))
        return np.asarray(y)

    def _surface(self, touching: bool):  # type: ignore[no-untyped-def]
        def depth(t: float, y: Array) -> float:
            return float(y[3] - SURFACE)

        depth.terminal, depth.direction = True, -1 if touching else 1  # type: ignore[attr-defined]
        return depth

    def _rates(self, name: str, touching: bool):  # type: ignore[no-untyped-def]
        law = self.laws[name]
        assert isinstance(law, Admittance)
        Mt, Bt, k = float(law.Mt), float(law.Bt), self.k if touching else 0.0
        Km, tau, Kp, Kd = self.Km, self.tau, self.Kp, self.Kd

        def rates(t: float, y: Array) -> list[float]:
            e, omega, vm, theta = y
            slip = SWING * np.sin(OMEGA * t) - vm - omega
            turn = (Km * (Kp * e + Kd * slip) - omega) / tau
            return [slip, turn, (k * (theta - SURFACE) - Bt * vm) / Mt, omega]

        return rates
