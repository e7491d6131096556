"""State matrices of one controller in one contact, exactly: loop, law and contact put together.

Where all controllers give the motion loop a velocity, the state is ``[xp, own, contact]``: the
motion loop from velocity to velocity, the states of the law (after them those of a filter of the
force) and those of the contact. Otherwise it is ``[xi, own, r]``, the motion loop from position to
position, and after them an integral that bleeds, the filter of the force and the memory of the
contact; r is the position reference that the robot integrates from a velocity, and only controllers
that command one have it.

The offset X_i of force control (thesis 6.41) is a memory that every switch takes anew.
The command of the motion loop is ``u = r`` in position mode and ``u = X_i + Kp (Fd - F)`` in force
mode. X_i is held, so a mode has no rest point of its own: it rests wherever X_i lets it, and in
coordinates of the position it has the eigenvalue zero. What decays is the motion. With
``w = xi'`` and constant commands every mode is ``w' = A w``, with the A that it has without an
offset, and X_i is gone. At a switch xi stays and u may jump: ``w+ = w + B (u+ - u)``.

- `reference`: X_i is the command before the switch, so u stays and w too.
- `measured`: X_i is the position theta, so ``u+ = theta``. As G(0) = 1, the lead of the command is
  ``u - theta = -C Ap^-1 w``, a form of w alone. It stands last among the coordinates here: a switch
  sets it to zero, and leaves the others as they are.

Both hold where the force at a switch to force control is Fd; otherwise u+ has the term
``Kp (Fd - F)`` besides, which is an input.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.controllers.laws.law import Response
from nrs_design.controllers.sensor import LowPass
from nrs_design.errors import AssemblyError
from nrs_design.loop.wires import Wires
from nrs_design.models.contact.law import AbstractLinearLaw, Reaction
from nrs_design.models.linear_form import ONE, LinearForm, combine, coordinates, zero
from nrs_design.models.motion_loop import JointMotionLoop, LoadedMotionLoop, Realization
from nrs_design.proof.matrix import multiply

Rows = list[LinearForm]


@dataclass(frozen=True, slots=True)
class ForceShare:
    """Shares of the contact force that act on the law and on the motor of a cut loop."""

    sensed: Fraction = Fraction(1)  # Share that reaches the law
    carried: Fraction = Fraction(1)  # Share that slows a motor with a load


# The closed loop of a proof.
WHOLE = ForceShare()


def velocity_mode(
    motion: Realization | JointMotionLoop,
    law: CompliantLaw,
    contact: AbstractLinearLaw,
    low_pass: LowPass | None = None,
    share: ForceShare = WHOLE,
) -> Rows:
    """Return A in deflection coordinates: for impedance control, thesis 6.28.

    ``xp' = Ap xp + Bp u``, ``v = Cp xp``, the contact from v to F, and the law from F to u. States
    of the low-pass stand between those of law and contact. Only `share` of the force acts.
    """
    law_end = motion.order + len(law.states)
    touch = law_end + (0 if low_pass is None else low_pass.order)
    state = coordinates(touch + len(contact.states))
    velocity = motion.output(len(state))
    if contact.has_mass:
        acceleration = _acceleration(motion, law, state)
        force, reaction = contact.react_accelerated(velocity, acceleration, state[touch:])
    else:
        force, reaction = contact.react(velocity, state[touch:])
    heard = combine((share.sensed, force))
    feedback: LinearForm = heard
    sensed: list[LinearForm] = []
    if low_pass is not None:
        feedback, sensed = low_pass.respond(heard, state[law_end:touch])
    if law.spring:
        # The integral of the command follows from the deflection, so it needs no state.
        feedback = combine((Fraction(1), feedback), (law.spring, motion.integral(state[touch])))
    command, rates = law.respond(feedback, state[motion.order : law_end])
    return [*motion.rates(command, combine((share.carried, force))), *rates, *sensed, *reaction]


def _acceleration(
    motion: Realization | JointMotionLoop, law: CompliantLaw, state: Sequence[LinearForm]
) -> LinearForm:
    """Return the rate of the velocity, where the force does not act on it at once.

    An `AssemblyError` if it does: the equations would be implicit.
    """
    loaded = isinstance(motion, JointMotionLoop) and motion.J is not None
    if not law.states or loaded:
        raise AssemblyError(
            "a hand, which has a mass, is not modelled for an admittance without virtual inertia, "
            "or with its load on the motor: its force would depend on itself",
            remedy="give impedance controllers Mt > 0, and leave load_inertia out",
            at=("actuator", "load_inertia") if loaded else ("controllers",),
        )
    command, _ = law.respond(zero(len(state)), state[motion.order : motion.order + len(law.states)])
    rates = motion.rates(command)
    return combine(*zip(motion.output(len(state))[: motion.order], rates, strict=True))


def replace_last(rows: Rows, form: LinearForm) -> Rows:
    """Return a mode with a form of the state in the place of the last one (``T A T^-1``)."""
    T, inverse = coordinates(len(rows)), coordinates(len(rows))
    T[-1] = list(form)
    inverse[-1] = [*(-entry / form[-1] for entry in form[:-1]), 1 / form[-1]]
    return [*multiply(multiply(T, rows), inverse)]


def add_idle(rows: Rows, rates: Mapping[int, Fraction]) -> Rows:
    """Return a mode among states that it leaves alone: by place, these decay at rates in 1/s."""
    size = len(rows) + len(rates)
    full = [zero(size) for _ in range(size)]
    places = [i for i in range(size) if i not in rates]
    for i, row in zip(places, rows, strict=True):
        for j, entry in zip(places, row, strict=True):
            full[i][j] = entry
    for i, rate in rates.items():
        full[i][i] = -rate
    return [*full]


def position_mode(
    motion: Realization | LoadedMotionLoop,
    law: CompliantLaw,
    contact: AbstractLinearLaw | None = None,
    low_pass: LowPass | None = None,
    bleeding: Fraction | None = None,
    share: ForceShare = WHOLE,
) -> Rows:
    """Return A where the motion loop follows a position: for force control, thesis 6.46.

    ``xi' = Ap xi + Bp u``, ``theta = Cp xi``, and the law from F to u. A velocity is integrated
    first, ``r' = -vm`` and ``u = r``. Where the integral w of another controller bleeds, at a rate
    in 1/s, it is in u. States are those of loop and law, r, w, the low-pass and the memory of the
    contact. An `AssemblyError` if the command depends on itself at once.
    """
    moves = law.commands == "velocity"
    lags = () if low_pass is None else low_pass.states
    memory = () if contact is None else contact.states[1:]
    w = Wires(
        (
            *motion.states,
            *law.states,
            *["r"] * moves,
            *["w"] * (bleeding is not None),
            *lags,
            *memory,
        )
    )
    left = [] if bleeding is None else [(ONE, w["w"])]
    pulled = [(law.spring, w["r"])] if moves else []
    size, heard = len(w.nothing), lags[-1] if lags else "sensed"
    law_state = [w[name] for name in law.states]
    # A law without force feedback closes no algebraic loop.
    takes_force = law.respond(w.nothing, law_state) != law.respond(coordinates(size)[0], law_state)
    w.rule("command", lambda: w.sum((ONE, w["r"] if moves else respond()[0]), *left))
    w.rule("velocity", lambda: motion.velocity(w.nothing, lambda: w["command"]))
    w.rule("force", lambda: react()[0])
    w.rule("sensed", lambda: w.sum((share.sensed, w["force"])))
    w.rule("felt", lambda: w.sum((ONE, w[heard]), *pulled))

    def react() -> Reaction:
        if contact is None:
            return w.nothing, []
        deflection = motion.output(size), *(w[name] for name in memory)
        return contact.react(w["velocity"] if contact.lags else w.nothing, deflection)

    def respond() -> Response:
        return law.respond(w["felt"] if takes_force else w.nothing, law_state)

    command, rates = respond()
    return [
        *motion.rates(w["command"], w.sum((share.carried, w["force"]))),
        *rates,
        *[command] * moves,
        *([] if bleeding is None else [w.sum((-bleeding, w["w"]))]),
        *([] if low_pass is None else low_pass.respond(w["sensed"], [w[name] for name in lags])[1]),
        *react()[1][1:],
    ]


def lead(motion: Realization) -> list[Fraction]:
    """Return ``u - theta`` as a linear form of ``w = xi'``: the y with ``y Ap = -C``.

    An `AssemblyError` if the motion loop does not rest where it is commanded to be, ``G(0) != 1``:
    then the lead depends on the position too.
    """
    last, C = motion.A[-1], motion.C
    if C[0] != -last[0] or not last[0]:
        raise AssemblyError(
            "an offset is not modelled for a motion loop that does not rest at its command: "
            "G(0) is not 1",
            remedy="use `offset: none`, or a transfer function with G(0) = 1",
            at=("motion_loop", "transfer_function"),
        )
    return [*(-c - a for c, a in zip(C[1:], last[1:], strict=True)), Fraction(1)]
