"""A loop below a safety layer, for adversaries: many runs at once, the law in single precision."""

from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import Admittance, ProportionalDerivative
from nrs_design.controllers.replica import step
from nrs_design.controllers.safety import SafetyLimits, add_safety
from nrs_design.controllers.step_law import StepFrame, StepLimits, build_law
from nrs_design.proof.saturation import Governed

PERIOD = Fraction(1, 500)
T = float(PERIOD)
MOTION = ProportionalDerivative(to_float32(Fraction("117359.43")), Fraction(2060))
GAIN = (Fraction("4.744866e-4"), Fraction("4.938534e-4"))
TAU = (Fraction("0.034398"), Fraction("0.035802"))
STIFFNESS = (Fraction(30), Fraction(60))
ANGLE = Fraction(3)
LIMITS = SafetyLimits(*map(to_float32, map(Fraction, ("0.17", "0.3", "0.005", "2e-6"))))
# Motor and tissue between two samples are seen at so many instants.
PARTS = 4


def gains(Mt: str, Bt: str):
    return Admittance(to_float32(Fraction(Mt)), to_float32(Fraction(Bt)))


def law_of(*, layer=True, soft="0.01", limits=LIMITS):
    """Return a law of a soft and of a stiff admittance; both are far outside of every proof."""
    frame = StepFrame(
        MOTION.Kp, MOTION.over(PERIOD), None, StepLimits(ANGLE, to_float32(Fraction(2)))
    )
    each = {"soft": gains("0.002", soft), "stiff": gains("0.01", "2.15")}
    law = build_law(frame, {name: g.discretize(PERIOD, "exact") for name, g in each.items()})
    return add_safety(law, limits) if layer else law


def governed(oldest=1, limits=LIMITS, **other):
    """Return the loop as a certificate has it."""
    return replace(
        Governed(
            GAIN,
            TAU,
            MOTION.Kp,
            MOTION.over(PERIOD),
            to_float32(PERIOD),
            limits.speed,
            limits.torque,
            limits.energy,
            limits.refill,
            STIFFNESS,
            oldest,
            ANGLE,
            "rpm",
        ),
        **other,
    )


@dataclass
class Runs:
    """What runs reached: one number for each, but for the books, of every sample."""

    speed: np.ndarray
    torque: np.ndarray
    error: np.ndarray
    command: np.ndarray
    work: np.ndarray = field(default_factory=lambda: np.zeros(0))  # Shape (samples, runs)
    withheld: np.ndarray = field(default_factory=lambda: np.zeros(0))


class Plants:
    """Motors and tissues, which change within their ranges at every sample."""

    def __init__(self, count, surface, rng, ends):
        self.theta, self.omega = np.zeros(count), np.zeros(count)
        self.surface, self.rng, self.ends = surface, rng, ends

    def deflection(self, theta=None):
        y = (self.theta if theta is None else theta) - self.surface
        return np.where(self.surface >= 0, np.maximum(y, 0), np.minimum(y, 0))

    def torque(self, stiffness, damping):
        """Return what tissue presses with; it does not pull."""
        side, y = np.where(self.surface >= 0, 1, -1), self.deflection()
        force = side * (stiffness * y + damping * self.omega)
        return side * np.where(y != 0, np.maximum(force, 0), 0)

    def move(self, command):
        """Yield angles and velocities at instants up to the next sample."""
        low, high = float(GAIN[0]), float(GAIN[1])
        fast, slow = float(TAU[0]), float(TAU[1])
        share = self.rng.random((2, len(command)))
        share = share.round() if self.ends else share
        Km, tau = low + share[0] * (high - low), fast + share[1] * (slow - fast)
        for part in range(1, PARTS + 1):
            t = T * part / PARTS
            E = np.exp(-t / tau)
            s = tau * (1 - E)
            yield (
                self.theta + s * self.omega + Km * (t - s) * command,
                E * self.omega + Km * (1 - E) * command,
            )


def run(law, adversary, count, samples, seed, oldest=1, ends=True, start=None, damping=0.0):
    """Let an adversary choose mode, states of the law, command, stiffness and age at every sample.

    Parameters
    ----------
    adversary : callable
        Takes k, the plants, the torque that is measured and a generator; returns mode, velocity
        command, velocity of the admittance (NaN leaves it) and stiffness.
    """
    rng = np.random.default_rng(seed)
    surface = np.where(rng.random(count) < 0.5, 1, -1) * rng.uniform(0, 0.02, count)
    plants = Plants(count, surface, rng, ends)
    states = {s.name: np.zeros(count, np.float32) for s in law.states}
    zero = np.zeros(count)
    felt = [zero] * (oldest + 1)
    found = Runs(zero, zero, zero, zero)
    work, withheld = [], []
    stiffness = np.full(count, float(STIFFNESS[0] if start is None else start))
    for k in range(samples):
        torque = plants.torque(stiffness, damping)
        felt = [torque, *felt[:oldest]]
        ages = rng.integers(0, oldest + 1, count) if k % 3 else np.full(count, oldest)
        seen = np.choose(ages, felt)
        mode, hand, velocity, stiffness = adversary(k, plants, seen, rng)
        if "velocity" in states:
            states["velocity"] = np.where(
                np.isnan(velocity), states["velocity"], velocity.astype(np.float32)
            )
        given = {
            "angle": plants.theta.astype(np.float32),
            "torque": seen.astype(np.float32),
            "velocity_command": hand.astype(np.float32),
            **states,
        }
        done = step(law, mode.astype(np.uint32), given)
        assert done.valid.all()
        error = np.abs(given["reference"].astype(float) - plants.theta)
        moved = done.states["reference"].astype(float) - given["reference"]
        work.append(given["torque"].astype(float) * moved)
        withheld.append(done.outputs.get("withheld", np.zeros(count)))
        command = done.outputs["command"].astype(float)
        found.command = np.maximum(found.command, np.abs(command))
        found.error = np.maximum(found.error, error)
        states = dict(done.states)
        for theta, omega in plants.move(command):
            # The stiffness may jump at once.
            largest = float(STIFFNESS[1]) * np.abs(plants.deflection(theta))
            constant = stiffness * np.abs(plants.deflection(theta))
            pressed = constant if getattr(adversary, "constant", False) else largest
            pressed = pressed + np.where(pressed > 0, damping * np.abs(omega), 0)
            found.speed = np.maximum(found.speed, np.abs(omega))
            found.torque = np.maximum(found.torque, pressed)
        plants.theta, plants.omega = theta, omega
    found.work, found.withheld = np.array(work), np.array(withheld)
    return found
