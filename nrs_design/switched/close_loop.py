"""Close the loop around every contact: the modes of one robot axis, exactly.

State of an impedance mode: ``[xp, vm, delta]``, the motion loop, the admittance velocity (absent
with zero virtual inertia) and the deflection. State of a position or force mode: ``xp`` alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import chain

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.laws import Admittance, PositionControl, ProportionalForce
from nrs_design.errors import AssemblyError
from nrs_design.models.environment import Contact
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix, multiply
from nrs_design.proof.system import Mode, SwitchedSystem, Time
from nrs_design.spec import SwitchingSpec
from nrs_design.switched.assumptions import CONTINUOUS, rule_texts
from nrs_design.switched.constraints import assemble_switching
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.parameter_box import Axis, box_corners
from nrs_design.switched.parameters import Corner

Row = list[Fraction]


@dataclass(frozen=True, slots=True)
class Realization:
    """Controllable canonical form ``xp' = A xp + B u``, ``v = C xp`` with ``B = [0, ..., 1]'``."""

    A: tuple[tuple[Fraction, ...], ...]
    C: tuple[Fraction, ...]

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.C)


def realize(loop: MotionLoop) -> Realization:
    """Return the minimal realization of a strictly proper motion loop (thesis 6.13-6.14).

    Raises
    ------
    AssemblyError
        If the transfer function is not strictly proper.
    """
    n = len(loop.denominator) - 1
    leading = loop.denominator[0]
    if n < 1 or len(loop.numerator) > n or leading == 0:
        raise AssemblyError(
            "the motion loop is not strictly proper",
            remedy="its numerator must have a lower degree than its denominator",
        )
    last = tuple(-c / leading for c in reversed(loop.denominator[1:]))
    shift = tuple(tuple(Fraction(int(j == i + 1)) for j in range(n)) for i in range(n - 1))
    padding = (Fraction(0),) * (n - len(loop.numerator))
    return Realization(
        (*shift, last), tuple(c / leading for c in reversed(loop.numerator)) + padding
    )


def close_loop(
    name: str,
    plant: Plant,
    loop: MotionLoop,
    design: ControllerDesign,
    coordinates: str,
    rules: SwitchingSpec | None = None,
    boxes: Mapping[str, GainBox] | None = None,
) -> SwitchedSystem:
    """Assemble every mode of an interaction design.

    One mode for each controller and each corner of the box of its gains and of the parameters of
    each environment that it may touch. Every entry of A is affine in stiffness, in damping, in Bt
    and in 1/Mt (without inertia: in 1/Bt), each for itself, so A is a convex combination of the
    corners in the whole box, and what decreases in the corners decreases there, however fast the
    parameters move.

    Parameters
    ----------
    name : str
        Name of the spec.
    plant : Plant
        Environments.
    loop : MotionLoop
        Closed motion loop G.
    design : ControllerDesign
        Gains that ship.
    coordinates : {"deflection", "force"}
        Last state of an impedance mode: the deflection (continuous when the stiffness changes
        in contact, so the physical choice) or the force (the thesis's choice).
    rules : SwitchingSpec, optional
        Rules for the change of controllers; by default any may follow any other at any time.
    boxes : mapping, optional
        Where the gains of impedance controllers may be, by name; by default, at what ships.

    Raises
    ------
    AssemblyError
        If the modes do not share one state, or the coordinates do not apply.
    """
    motion = realize(loop)
    rules = rules or SwitchingSpec()
    boxes = boxes or {}
    parts = {
        controller.name: tuple(
            _controller_modes(controller, plant, motion, coordinates, boxes.get(controller.name))
        )
        for controller in design.controllers
    }
    modes = tuple(chain.from_iterable(parts.values()))
    sizes = sorted({mode.A.shape[0] for mode in modes})
    if len(sizes) != 1:
        raise AssemblyError(
            f"the modes have {' and '.join(map(str, sizes))} states, so they share no state",
            remedy="give all impedance controllers a virtual inertia Mt > 0, or none of them",
            at=("controllers",),
        )
    states = _state_names(motion.order, sizes[0], coordinates)
    assumptions = _assumptions(design, coordinates, rules, boxes, given=loop.given)
    groups = {key: tuple(Corner(mode.name) for mode in part) for key, part in parts.items()}
    switching = assemble_switching(rules, groups)
    return SwitchedSystem(name, Time.CONTINUOUS, states, modes, assumptions, switching)


def _controller_modes(
    controller: Controller,
    plant: Plant,
    motion: Realization,
    coordinates: str,
    box: GainBox | None,
) -> Iterator[Mode]:
    law = controller.law
    if isinstance(law, PositionControl):
        yield Mode(controller.name, RationalMatrix.from_rows(motion.A))
        return
    gains: tuple[Axis, ...] = ()
    if isinstance(law, Admittance):
        gains = (box or GainBox.point(law)).axes
    for environment in map(plant.environment, controller.contacts):
        name = f"{controller.name}/{environment.name}"
        axes = (Axis("k", environment.stiffness), Axis("b", environment.damping), *gains)
        rows_at = partial(_rows_at, law, environment.name, motion, coordinates)
        for corner in box_corners(axes, rows_at, name):
            label = f"{name}/{corner.label}" if corner.label else name
            yield Mode(label, RationalMatrix.from_rows(corner.rows))


def _rows_at(
    law: Admittance | ProportionalForce,
    environment: str,
    motion: Realization,
    coordinates: str,
    values: Mapping[str, Fraction],
) -> list[Row]:
    """Return A at the given parameters of the contact and, in impedance control, gains."""
    contact = Contact(environment, values["k"], values["b"])
    if isinstance(law, ProportionalForce):
        return force_mode(motion, law, contact)
    rows = impedance_mode(motion, Admittance(values["Mt"], values["Bt"]), contact)
    return to_force_coordinates(rows, motion, contact) if coordinates == "force" else rows


def impedance_mode(motion: Realization, law: Admittance, contact: Contact) -> list[Row]:
    """Return A of an impedance mode in deflection coordinates (thesis 6.28).

    ``xp' = Ap xp + Bp (vc - vm)``, ``Mt vm' = -Bt vm + F``, ``delta' = Cp xp``,
    ``F = k delta + b delta'``. With ``Mt = 0`` the velocity is ``vm = F / Bt``.

    Parameters
    ----------
    motion : Realization
        Of the motion loop.
    law : Admittance
        With its gains.
    contact : Contact
        The environment at fixed parameters.
    """
    n = motion.order
    has_mass = law.Mt != 0
    size = n + 1 + has_mass
    force = [contact.damping * c for c in motion.C] + [Fraction(0)] * has_mass + [contact.stiffness]
    rows = [[*row, *[Fraction(0)] * (size - n)] for row in motion.A]
    if has_mass:
        rows[-1][n] -= 1
        velocity = [f / law.Mt for f in force]
        velocity[n] -= law.Bt / law.Mt
        rows.append(velocity)
    else:
        rows[-1] = [entry - f / law.Bt for entry, f in zip(rows[-1], force, strict=True)]
    rows.append([*motion.C, *[Fraction(0)] * (size - n)])
    return rows


def to_force_coordinates(rows: list[Row], motion: Realization, contact: Contact) -> list[Row]:
    """Replace the last state delta by the force ``F = k delta + b Cp xp`` (similarity T A T^-1).

    Parameters
    ----------
    rows : list of list of Fraction
        A in deflection coordinates.
    motion : Realization
        Of the motion loop.
    contact : Contact
        The environment at fixed parameters.
    """
    size, n = len(rows), motion.order
    T = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    inverse = [list(row) for row in T]
    T[-1][:n] = [contact.damping * c for c in motion.C]
    T[-1][-1] = contact.stiffness
    inverse[-1][:n] = [-contact.damping * c / contact.stiffness for c in motion.C]
    inverse[-1][-1] = 1 / contact.stiffness
    return multiply(multiply(T, rows), inverse)


def force_mode(motion: Realization, law: ProportionalForce, contact: Contact) -> list[Row]:
    """Return A of a force mode, ``Ap - Bp Kp k Cp`` (thesis 6.46).

    Parameters
    ----------
    motion : Realization
        Of the motion loop.
    law : ProportionalForce
        With its gain.
    contact : Contact
        The environment at fixed parameters.

    Raises
    ------
    AssemblyError
        If the environment is damped: its force then depends on the input itself.
    """
    if contact.damping != 0:
        raise AssemblyError(
            f"force control in contact with {contact.label}, which has damping, is not modelled",
            remedy="use an elastic environment for force controllers",
            at=("environments", contact.label, "damping"),
        )
    rows = [list(row) for row in motion.A]
    gain = law.Kp * contact.stiffness
    rows[-1] = [entry - gain * c for entry, c in zip(rows[-1], motion.C, strict=True)]
    return rows


def _state_names(motion_order: int, size: int, coordinates: str) -> tuple[str, ...]:
    names = [f"xp{i + 1}" for i in range(motion_order)]
    if size - motion_order == 2:
        names.append("vm [rad/s]")
    if size > motion_order:
        names.append("F [N*m]" if coordinates == "force" else "delta [rad]")
    return tuple(names)


_INPUTS = (
    "All inputs are zero (velocity command, reference force, motion of the environment); all modes "
    "then rest at one point, the state zero.",
    "Under a constant command the modes may rest at different points. Where stability is proved, "
    "bounded inputs keep the state bounded; how far it goes, and that it settles, is not claimed.",
)
_CONTACT_KEPT = (
    (Admittance, "Contact is not lost: free motion is not one of the modes."),
    (
        ProportionalForce,
        "Contact is not lost while force is controlled: the environment would pull as it pushes.",
    ),
)


def _assumptions(
    design: ControllerDesign,
    coordinates: str,
    rules: SwitchingSpec,
    boxes: Mapping[str, GainBox],
    *,
    given: bool,
) -> tuple[str, ...]:
    motion = (
        "The motion loop is the transfer function G(s) that the spec states, whatever the motion "
        "gains listed here."
        if given
        else "The motion loop is the linear actuator model of the spec, at its nominal values, "
        "under the motion gains listed here."
    )
    kept = tuple(
        text
        for law, text in _CONTACT_KEPT
        if any(isinstance(c.law, law) for c in design.controllers)
    )
    impedance = any(isinstance(c.law, Admittance) for c in design.controllers)
    contacts = [
        f"{c.name} is active only in contact with {' or '.join(c.contacts)}."
        for c in design.controllers
        if c.contacts
    ]
    ranged = {name: box for name, box in boxes.items() if not box.fixed}
    ranges = [text for name, box in ranged.items() for text in box.range_texts(name)]
    shipped = "The gains are the single-precision numbers listed here"
    last = {
        "deflection": "The deflection is continuous at a switch; the force may jump.",
        "force": "Wherever stiffness or damping changes, at a switch or within its range, the "
        "force stays and the deflection jumps (the thesis's coordinates; not physical in lasting "
        "contact).",
    }[coordinates]
    return (
        motion,
        *_INPUTS,
        "The axes of the robot do not act on each other.",
        *contacts,
        "In contact, the environment follows its linear model; its parameters stay in the "
        "declared ranges and may change arbitrarily fast.",
        *((last,) if impedance else ()),
        *kept,
        *_switch_texts(rules),
        "Continuous time: sampling, delay, quantization, friction and saturation are not modelled.",
        f"{shipped}, or anywhere in their ranges." if ranged else f"{shipped}.",
        *ranges,
        *dict.fromkeys(box.memory_text for box in ranged.values()),
    )


def _switch_texts(rules: SwitchingSpec) -> tuple[str, ...]:
    if rules.is_arbitrary:
        return (f"States are {CONTINUOUS}; any switching signal is possible.",)
    environment = (
        "While a controller is active, the environment that it touches may change among its "
        "contacts at any time."
    )
    contacts = () if rules.dwell_time is not None else (environment,)
    return (f"States are {CONTINUOUS}.", *rule_texts(rules, "controller"), *contacts)
