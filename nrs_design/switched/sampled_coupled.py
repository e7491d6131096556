"""All axes of a robot at once in the sampled loop: what their links do within a period.

Let ``z = omega - v`` be the slip, v the speeds that the motors come to under the held commands,
``D = diag(1/tau_i)`` with entries in [d, D1], and ``Lambda = (I + M/J)^-1``, symmetric at every
moment, with eigenvalues in [l, u], s among them and ``r = max(u - s, s - l)``:

    z' = -Lambda D z + h,    |h| <= kappa |omega| + gamma |delta|,    kappa = u c/J,  gamma = u g/J

With ``y = D^(1/2) z`` the slope of ``|y|^2/2`` is ``-(D^(1/2) y)' Lambda (D^(1/2) y) + y' D^(1/2)
h``, so with H the largest ``|h|`` in the period ``|D z(t)| <= D1 (exp(-l d t) |z(0)| + t H)``. Each
axis by itself with a motor of the time constant tau/s has the slip ``exp(-s D t) z(0)``. The
difference p has ``p' = -s D p - (Lambda - s I) D z + h`` and ``p(0) = 0``, so, as ``l <= s``,

    |p(t)| <= r D1 t exp(-l d t) |z(0)| + t H (1 + r D1 t/2),    exp(-x) <= 1/(1 + x)

and the angles differ by at most ``T^2/2 (r D1 |z(0)| + H (1 + r D1 T/2))``. Speeds change by at
most ``T (u D1 |z(0)| + u D1 T H + H)``, angles by T times the largest speed. So with ``kappa' =
kappa + gamma T``, if ``e = 1 - kappa' T (1 + u D1 T)`` is positive,

    H <= (kappa' |omega(0)| + kappa' T u D1 |z(0)| + gamma |delta(0)|)/e

A vector of at most a sum of three numbers is a sum of three vectors, each within its own: up to six
couplings, on the speed and on the way, by slip, speed and deflection.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import coordinates
from nrs_design.proof.channels import Channel, Coupling
from nrs_design.switched.coupled import (
    CORIOLIS,
    GRAVITY,
    INERTIA,
    AxesCoupling,
    check_gravity,
    couplings_along,
    not_below,
)
from nrs_design.switched.sampled_frame import INPUTS, Frame
from nrs_design.switched.sampled_inputs import SampledMode, known_entries

# Of the middle of a range, which need not be exact.
LARGEST_DENOMINATOR = 1000


@dataclass(frozen=True, slots=True)
class Push:
    """Bound on how far a period takes all axes from where each would be alone, per signal."""

    # slip, speed, deflection: times the norm of the slips, speeds and deflections over all axes, at
    # the sample.
    slip: Fraction
    speed: Fraction
    deflection: Fraction

    @property
    def sizes(self) -> dict[str, Fraction]:
        """The bounds that are not zero, by what acts."""
        found = {INERTIA: self.slip, CORIOLIS: self.speed, GRAVITY: self.deflection}
        return {name: size for name, size in found.items() if size}


def slowed_motor(ranges: ActuatorRanges, coupling: AxesCoupling) -> ActuatorRanges:
    """Return the motor of an axis with links of the middle weight: its time constant is tau/s.

    Parameters
    ----------
    ranges : ActuatorRanges
        Of a drive without links.
    coupling : AxesCoupling
        What is known of the links.
    """
    s, tau = _middle(coupling), ranges.time_constant
    return replace(
        ranges, time_constant=Interval(tau.nominal / s, tau.low / s, tau.high / s, tau.varies)
    )


def couplings_of(
    frame: Frame,
    coupling: AxesCoupling,
    ranges: ActuatorRanges,
    channels: Sequence[Channel],
    motions: Sequence[SampledMode],
    *,
    losable: bool,
    entries: Sequence[int] | None = None,
) -> Iterator[Coupling]:
    """Yield what the links do to the speed and to the way of an axis within a period.

    Parameters
    ----------
    frame : Frame
        Of all modes, with the motor of `slowed_motor`.
    coupling : AxesCoupling
        What is known of the links.
    ranges : ActuatorRanges
        Of a drive without links.
    channels : sequence of Channel
        The disturbances.
    motions : sequence of SampledMode
        All modes, those of free motion last.
    losable : bool
        Whether contact may be lost where the spring of the tissue ends.
    entries : sequence of int, optional
        Of which entries of the forms of a frame the rows are, in the place of `coupled_entries`.

    Raises
    ------
    AssemblyError
        If the period is too long, or gravity changes while contact may be lost.
    """
    if coupling.gravity_gradient is not None:
        check_gravity(losable=losable)
    states = frame.states
    omega, delta = states.index("omega [rad/s]"), len(states) - 1
    unit = coordinates(len(states))
    way = list(unit[delta])
    if states[0] == "e [rad]":
        way[0] = Fraction(-1)
    on_speed, on_way = pushes(coupling, ranges.time_constant, frame.period)
    seen = coupled_entries(frame, channels) if entries is None else entries
    slips = [[motion.slip[i] for i in seen] for motion in motions]
    seen_by = {
        INERTIA: slips,
        CORIOLIS: [[Fraction(int(i == omega)) for i in seen]] * len(motions),
        GRAVITY: [[Fraction(int(i == delta)) for i in seen]] * len(motions),
    }
    found = (("on the speed", unit[omega], on_speed), ("on the way", way, on_way))
    yield from couplings_along(
        [(what, column, push.sizes) for what, column, push in found], seen_by
    )


def coupled_entries(frame: Frame, channels: Sequence[Channel]) -> list[int]:
    """Return where states, declared disturbances and roundings are in a form of a frame.

    Parameters
    ----------
    frame : Frame
        Of all modes.
    channels : sequence of Channel
        The disturbances.
    """
    first = len(frame.states) + len(INPUTS)
    return [*known_entries(frame, channels), *range(first, first + len(frame.roundings))]


def pushes(coupling: AxesCoupling, tau: Interval, period: Fraction) -> tuple[Push, Push]:
    """Return how far the links take speeds and angles within a period, over all axes.

    Parameters
    ----------
    coupling : AxesCoupling
        What is known of the links.
    tau : Interval
        Time constant of a drive without links, in s.
    period : Fraction
        In s.

    Raises
    ------
    AssemblyError
        If the period is too long for the bound.
    """
    (low, high), s, T = coupling.shares, _middle(coupling), period
    r, fast, slow = max(high - s, s - low), 1 / tau.low, 1 / tau.high
    gamma = high * (coupling.gravity_gradient or 0) / coupling.drive
    kappa = high * (coupling.coriolis or 0) / coupling.drive + gamma * T
    left = 1 - kappa * T * (1 + high * fast * T)
    if left <= 0:
        raise AssemblyError(
            "a period is too long for a bound on what the links do within it",
            remedy="shorten the period, or leave coupling out",
            at=("coupling",),
        )
    # The largest |h| within the period, per |z|, |omega| and |delta| at its beginning.
    torques = Push(kappa * T * high * fast / left, kappa / left, gamma / left)
    share = 1 + r * fast * T / 2
    speed = Push(
        not_below(r * fast * T / (1 + low * slow * T) + T * share * torques.slip),
        not_below(T * share * torques.speed),
        not_below(T * share * torques.deflection),
    )
    half = T**2 / 2
    way = Push(
        not_below(half * (r * fast + share * torques.slip)),
        not_below(half * share * torques.speed),
        not_below(half * share * torques.deflection),
    )
    return speed, way


def _middle(coupling: AxesCoupling) -> Fraction:
    """Return s, a short number near the middle of the eigenvalues of Lambda, and among them."""
    low, high = coupling.shares
    short = ((low + high) / 2).limit_denominator(LARGEST_DENOMINATOR)
    return short if low <= short <= high else (low + high) / 2
