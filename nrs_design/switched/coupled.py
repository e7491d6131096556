"""All axes of a robot at once: what the inertia of the links does to the modes of one axis.

The numbers of a coupling are declared, or computed from a robot. With N axes, J the inertia of a
drive and M(q) that of the links, ``(J I + M) q'' = J a - C q' - (G(q) - G(q0))``, where a_i is the
row of omega in the mode of axis i. Divided by J, with ``Lambda = (I + M/J)^-1``, ``l = 1/(1 +
mbar/J)``, ``u = 1/(1 + m/J)``, ``s = (l + u)/2`` and ``r = (u - l)/2``:

- ``|(Lambda - s I) a| <= r |a|``, as Lambda is symmetric with eigenvalues in [l, u];
- ``|(Lambda/J) C q'| <= (u c/J) |q'|`` where ``|C(q, q') q'| <= c |q'|``, so below some speed only;
- ``|(Lambda/J) (G(q) - G(q0))| <= (u g/J) |q - q0|`` where ``|G(q) - G(q0)| <= g |q - q0|``: a mean
  of a gradient along the straight way is no larger than its largest norm there.

So a mode has its row of omega times s, and three couplings on omega. Averages of modes have the
same averages of columns and rows, since s, r, u, c, g and J are the same everywhere.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.models.linear_form import LinearForm, coordinates
from nrs_design.proof.bounds import upper
from nrs_design.proof.channels import Coupling
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text
from nrs_design.spec.coupling import CouplingSpec
from nrs_design.spec.exact import parse_exact
from nrs_design.spec.robot_bounds import ON_TRUST
from nrs_design.switched.assumption import Assumption, say
from nrs_design.switched.assumptions import UNCOUPLED

DECLARED = "declared, not computed from a robot"
# Of a robot.
JOINTS = 3
# Of a bound that is multiplied by a speed.
DIGITS = 6
AT_ONCE = say("period.axes", "one clock for all axes")
_LEFT = (
    ", nor that the disturbances leave it there: a bound, also that on the velocity, holds as long "
    "as they do"
)
OMEGA, DELTA = "omega [rad/s]", "delta [rad]"
# Through what the axes act on each other.
INERTIA, CORIOLIS, GRAVITY = "the inertia of the links", "Coriolis torques", "gravity"


@dataclass(frozen=True, slots=True)
class AxesCoupling:
    """What is known about the links of a robot, in SI units."""

    drive: Fraction  # J, the inertia of each drive at its joint
    # lightest, heaviest: every eigenvalue of the matrix of inertia M(q) of the links is between
    # them.
    lightest: Fraction
    heaviest: Fraction
    # Coriolis and centrifugal torques are at most this times the speed; None leaves them out.
    coriolis: Fraction | None = None
    speed: str | None = None  # As long as the speed is at most this, with its unit
    # The torque of gravity changes by at most this times the way from the pose of rest; None leaves
    # it out.
    gravity_gradient: Fraction | None = None
    source: str = DECLARED  # Where the numbers come from, for the assumptions
    poses: str = "all poses that are used"  # In which poses they hold
    count: int | None = None  # How many axes there are, if that is known

    @classmethod
    def of(cls, spec: CouplingSpec, drive: Fraction) -> AxesCoupling:
        """Read what a spec declares, or the bounds of the robot that it names.

        Parameters
        ----------
        spec : CouplingSpec
            The declaration.
        drive : Fraction
            The J.

        Raises
        ------
        AssemblyError
            If it names a robot, and has not been read from its file.
        """
        if spec.robot is not None:
            return cls._of_robot(spec, drive)
        assert spec.inertia is not None
        (lightest, heaviest), coriolis = spec.inertia, spec.coriolis
        gradient = spec.gravity_gradient
        return cls(
            drive,
            lightest.exact,
            heaviest.exact,
            None if coriolis is None else coriolis.exact,
            None if spec.speed is None else spec.speed.text,
            None if gradient is None else gradient.exact,
            count=spec.axes,
        )

    @classmethod
    def _of_robot(cls, spec: CouplingSpec, drive: Fraction) -> AxesCoupling:
        bounds = spec.bounds
        if bounds is None:
            raise AssemblyError(
                "the bounds of the robot are read with the file of the spec, and this is a text",
                remedy="read the spec from its file",
                at=("coupling", "robot"),
            )
        speed, at_rest = spec.speed, spec.gravity_compensated == "at-rest"
        return cls(
            drive,
            bounds.lightest,
            bounds.heaviest,
            None if speed is None else not_below(bounds.velocity_torques * speed.not_below),
            None if speed is None else speed.text,
            bounds.gravity_gradient if at_rest else None,
            f"{ON_TRUST} of robot {bounds.name}, SHA-256 {bounds.id}, which was made from its "
            f"spec, SHA-256 {bounds.sha256}, in the assembly mode of its elbow_sign, with its "
            "masses, lengths, gravity and base tilt, of rigid links without friction, "
            "counter-masses and springs; `nrs-design gate` and `nrs-design verify --bounds` "
            "compute it again",
            f"all poses with {bounds.workspace}, which are those that are used",
            JOINTS,
        )

    @property
    def shares(self) -> tuple[Fraction, Fraction]:
        """The smallest and the largest eigenvalue of ``(I + M/J)^-1``."""
        return self.drive / (self.drive + self.heaviest), self.drive / (self.drive + self.lightest)

    def scaled(self, scale: Fraction) -> AxesCoupling:
        """Return it with the range of inertia stretched about its middle, but not below zero.

        The other bounds are multiplied.

        Parameters
        ----------
        scale : Fraction
            Not negative.
        """
        middle = (self.lightest + self.heaviest) / 2
        half = scale * (self.heaviest - self.lightest) / 2
        gradient, source = self.gravity_gradient, self.source
        if scale != 1 and source != DECLARED:
            source = f"stretched by {exact_text(scale)} from what was {source}"
        return replace(
            self,
            source=source,
            lightest=max(middle - half, Fraction(0)),
            heaviest=middle + half,
            coriolis=None if self.coriolis is None else scale * self.coriolis,
            gravity_gradient=None if gradient is None else scale * gradient,
        )


def couple_axes(system: SwitchedSystem, coupling: AxesCoupling) -> SwitchedSystem:
    """Return the modes of an axis among others that act on it, and in which bounds they do.

    Parameters
    ----------
    system : SwitchedSystem
        One axis in the physical states of its motion loop, in continuous time; what disturbs it
        goes through the links as its motor does.
    coupling : AxesCoupling
        What is declared.

    Raises
    ------
    AssemblyError
        If the states do not tell the speed, or for gravity the deflection, or contact may be lost
        where gravity changes.
    """
    omega = _index(system, OMEGA)
    low, high = coupling.shares
    mean, radius = (low + high) / 2, (high - low) / 2
    free = () if system.contact is None else system.contact.free
    every = (*system.modes, *free)
    channels = [
        [column.fractions()[omega][0] for column in channel.columns] for channel in system.channels
    ]
    disturbed = [[column[k] for column in channels] for k in range(len(every))]
    rows = [
        [*mode.A.fractions()[omega], *others] for mode, others in zip(every, disturbed, strict=True)
    ]
    unit = coordinates(system.order + len(channels))
    seen = {INERTIA: rows, CORIOLIS: [unit[omega]] * len(every)}
    if coupling.gravity_gradient is not None:
        seen[GRAVITY] = [unit[_deflection(system, omega)]] * len(every)
    sizes = {INERTIA: radius}
    for name, bound in ((CORIOLIS, coupling.coriolis), (GRAVITY, coupling.gravity_gradient)):
        if bound is not None:
            sizes[name] = high * bound / coupling.drive
    push = ("", unit[omega][: system.order], sizes)
    contact = system.contact
    if contact is not None:
        contact = replace(contact, free=_slowed(contact.free, omega, mean))
    return replace(
        system,
        modes=_slowed(system.modes, omega, mean),
        contact=contact,
        channels=tuple(
            replace(
                channel,
                columns=tuple(_slowed_rows(column, omega, mean) for column in channel.columns),
            )
            for channel in system.channels
        ),
        couplings=tuple(couplings_along([push], seen)),
        assumptions=among_axes(system.assumptions, coupling, disturbed=bool(system.channels)),
        axes=coupling.count if system.channels else None,
    )


def couplings_along(
    pushes: Sequence[tuple[str, LinearForm, Mapping[str, Fraction]]],
    seen: Mapping[str, Sequence[LinearForm]],
) -> Iterator[Coupling]:
    """Yield what the other axes do to one: along a column, at most a size times what is seen.

    Parameters
    ----------
    pushes : sequence of (str, LinearForm, mapping of str to Fraction)
        What is pushed, the column, and the size for each cause; a cause without one is left out.
    seen : mapping of str to sequence of LinearForm
        For each cause, the form of every mode whose norm over all axes bounds it.
    """
    for cause, rows in seen.items():
        for what, column, sizes in pushes:
            if (size := sizes.get(cause)) is not None:
                B = RationalMatrix.from_rows([[entry] for entry in column])
                bounds = ([[size * entry for entry in row]] for row in rows)
                bound = tuple(map(RationalMatrix.from_rows, bounds))
                yield Coupling(f"{cause} {what}".rstrip(), (B,) * len(rows), bound)


def among_axes(
    assumptions: Iterable[str],
    coupling: AxesCoupling,
    *,
    sampled: bool = False,
    disturbed: bool = False,
) -> tuple[str, ...]:
    """Return assumptions with what is known of the axes in the place of their not being coupled.

    Parameters
    ----------
    assumptions : iterable of str
        Of one axis.
    coupling : AxesCoupling
        What is declared.
    sampled : bool
        Whether a processor runs the law.
    disturbed : bool
        Whether there are disturbances, which may take the speed beyond what is declared.
    """
    return tuple(
        text
        for known in assumptions
        for text in (
            (*_texts(coupling, disturbed=disturbed), *((AT_ONCE,) if sampled else ()))
            if known == UNCOUPLED
            else (known,)
        )
    )


def _slowed(modes: tuple[Mode, ...], omega: int, mean: Fraction) -> tuple[Mode, ...]:
    """Return the modes with the middle of the range of inertia on their axis."""
    return tuple(Mode(mode.name, _slowed_rows(mode.A, omega, mean)) for mode in modes)


def _slowed_rows(M: RationalMatrix, omega: int, mean: Fraction) -> RationalMatrix:
    rows = M.fractions()
    rows[omega] = [mean * entry for entry in rows[omega]]
    return RationalMatrix.from_rows(rows)


def _index(system: SwitchedSystem, state: str) -> int:
    if state not in system.states:
        raise AssemblyError(
            f"axes that act on each other are not modelled without a state {state}",
            remedy="remove coupling, or give impedance controllers and an actuator with "
            "load_inertia",
            at=("coupling",),
        )
    return system.states.index(state)


def _deflection(system: SwitchedSystem, omega: int) -> int:
    """Return the place of the deflection, which is how far the axis is from rest."""
    delta, unit = _index(system, DELTA), coordinates(system.order)
    moves = all(m.A.fractions()[delta] == unit[omega] for m in system.modes)
    check_gravity(losable=system.contact is not None or not moves)
    return delta


def check_gravity(*, losable: bool) -> None:
    """Refuse a change of gravity where there is no position of rest.

    Parameters
    ----------
    losable : bool
        Whether contact may be lost.

    Raises
    ------
    AssemblyError
        If it may.
    """
    if losable:
        raise AssemblyError(
            "that gravity changes is modelled where contact is kept, and has a position of rest",
            remedy="use `contact: kept`, or remove gravity_gradient",
            at=("coupling", "gravity_gradient"),
        )


def _texts(coupling: AxesCoupling, *, disturbed: bool) -> Iterator[Assumption]:
    """Say what is taken for granted about the axes, and where it comes from."""
    low, high = (exact_text(m) for m in (coupling.lightest, coupling.heaviest))
    yield say("links.axes", drive=exact_text(coupling.drive))
    yield say("touched-alone.axis")
    yield say(
        "links.inertia",
        f"eigenvalues of M(q) in [{low}, {high}] kg*m^2",
        low=low,
        high=high,
        poses=coupling.poses,
        source=coupling.source,
    )
    if coupling.coriolis is None:
        yield say("joint-speed.left-out", "speeds near zero")
    else:
        yield say(
            "joint-speed.bounded",
            f"speed below {coupling.speed}",
            coriolis=exact_text(coupling.coriolis),
            source=_shortly(coupling),
            speed=coupling.speed,
            also=_LEFT if disturbed else "",
        )
    if coupling.gravity_gradient is None:
        yield say("gravity.all-poses", coupling.poses)
    else:
        gradient = exact_text(coupling.gravity_gradient)
        bound = f"{gradient} N*m/rad"
        yield say("gravity.rest", bound, gradient=gradient, source=_shortly(coupling))
        if coupling.source != DECLARED:
            yield say("gravity.straight", coupling.poses)


def _shortly(coupling: AxesCoupling) -> str:
    """Say once in full where the numbers come from."""
    return DECLARED if coupling.source == DECLARED else "on trust as the inertia is, in those poses"


def not_below(number: Fraction) -> Fraction:
    """Return a number of few digits that is not below one that is not negative."""
    return parse_exact(upper(number, DIGITS)) if number else number
