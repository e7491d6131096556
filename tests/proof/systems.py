"""Systems and genuine evidence that several tests of evidence share."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from itertools import product
from pathlib import Path
from random import Random
from typing import Any

from nrs_design.controllers.laws import Admittance
from nrs_design.loop.modes import velocity_mode
from nrs_design.models.contact import KelvinVoigt
from nrs_design.models.motion_loop import Realization
from nrs_design.proof.channels import Channel, Output, Rounding
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.saturation import CutOff, Saturation, Start
from nrs_design.proof.switching import ARBITRARY, NOWHERE, Clock, Reset, Stay, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import first_accepted
from nrs_design.search.certify import Limits, certify
from nrs_design.search.family import floats_in_silence
from nrs_design.search.invariant_ellipsoid import search_ellipsoid
from nrs_design.search.method import Method
from nrs_design.search.work import Allowance
from tests.proof.graphs import shape_of
from tests.support import Entry, Rows, dayawansa_martin, family, matrix
from tests.tables import table


def oscillator(kbar: Entry, switching: Switching = ARBITRARY) -> SwitchedSystem:
    """Stable under arbitrary switching iff kbar < 6.98513... (Zelentsovsky 1994)."""
    return family([[0, 1], [-2, -1]], [[0, 1], [-2 - Fraction(kbar), -1]], switching=switching)


CORNERS = Switching(fixed_ends=(("m0", "m1", "m2", "m3"),))


def companion(k: Entry, m: Entry, switching: Switching = CORNERS) -> SwitchedSystem:
    """Roots of ``z^2 - m z + k`` with k from 0 and abs(m) up to bounds.

    Stable for every constant k and m iff both bounds are below 1 (Jury).
    """
    ends = product((0, Fraction(k)), (-Fraction(m), Fraction(m)))
    matrices = [[[0, 1], [-product_, total]] for product_, total in ends]
    return family(*matrices, time=Time.DISCRETE, switching=switching)


def two_springs() -> SwitchedSystem:
    """Stiffness and damping in wide ranges, both constant; stable iff both are positive."""
    rows = [[[0, 1], [-k, -b]] for k, b in product((1, 60), (1, 3))]
    return family(*rows, switching=CORNERS)


def geromel_colaneri(dwell: Entry, **rules: object) -> SwitchedSystem:
    """LMI proof iff the dwell time exceeds 2.75084 s; unstable up to 2.70775 s (2006)."""
    switching = Switching(Fraction(dwell), **rules)
    return family([[0, 1], [-10, -1]], [[0, 1], ["-0.1", "-0.5"]], switching=switching)


def branicky() -> SwitchedSystem:
    """Two Hurwitz modes that grow under switching (Branicky 1998)."""
    return family([[-1, 10], [-100, -1]], [[-1, 100], [-10, -1]])


def golden(c: Entry) -> SwitchedSystem:
    """Joint spectral radius c (1 + sqrt 5)/2 (Jungers 2009)."""
    c = Fraction(c)
    return family([[c, c], [0, c]], [[c, 0], [c, c]], time=Time.DISCRETE)


def ando_shih(c: Entry, switching: Switching = ARBITRARY) -> SwitchedSystem:
    """Joint spectral radius c, but no quadratic function beyond 0.7071 (Ando and Shih 1998)."""
    c = Fraction(c)
    pair = [[c, 0], [c, 0]], [[0, c], [0, -c]]
    return family(*pair, time=Time.DISCRETE, switching=switching)


def shears(switching: Switching = ARBITRARY) -> SwitchedSystem:
    """Both modes have the eigenvalue -1 twice, their average has the eigenvalue 4."""
    return family([[-1, 10], [0, -1]], [[-1, 0], [10, -1]], switching=switching)


def degenerate_dual() -> SwitchedSystem:
    """Dayawansa and Martin at a = 6 beside a decoupled stable state."""
    return family([[-1, 0, 0], [0, -1, -1], [0, 1, -1]], [[-1, 0, 0], [0, -1, -6], [0, "1/6", -1]])


def robot(Mt: str, contacts: Sequence[tuple[str, str]]) -> SwitchedSystem:
    """Impedance modes on the motion loop of thesis 6.3.2.2, for pairs of stiffness and Bt."""
    motion = Realization(
        ((Fraction(0), Fraction(1)), (Fraction("-1618.80"), Fraction("-56.89"))),
        (Fraction("1618.80"), Fraction("28.4160")),
    )
    return family(
        *(
            velocity_mode(
                motion,
                Admittance(Fraction(Mt), Fraction(Bt)),
                KelvinVoigt(Fraction(k), Fraction(0)),
            )
            for k, Bt in contacts
        )
    )


def resets_between(*maps: tuple[str, str, Rows]) -> tuple[Reset, ...]:
    return tuple(Reset(source, target, matrix(rows)) for source, target, rows in maps)


def sheared_in_stays(count: int) -> SwitchedSystem:
    """Return two shears and a map between, each in force for at least so many steps.

    In turns for N steps each, the shears keep ``(1 + 2 N^2 + 2 N sqrt(N^2 + 1))/4^N`` of a state:
    1.46 for one step, 1.12 for two, 0.594 for three.
    """
    shears = (
        [["1/2", "1"], ["0", "1/2"]],
        [["1/2", "0"], ["1", "1/2"]],
        [["1/2", "0"], ["0", "1/4"]],
    )
    names, ahead = ["m0", "m1", "m2"], []
    for kind, spent in product(range(3), range(count)):
        last = spent == count - 1
        own = kind * count + min(spent + 1, count - 1)
        ahead.append(tuple(own if k == kind else k * count if last else -1 for k in range(3)))
    clock = Clock(3 * count, (names[0],), tuple(ahead), ((names[1],),))
    return replace(family(*shears, time=Time.DISCRETE), clock=clock)


def rectangular() -> SwitchedSystem:
    """A mode of two states and one of one, joined by contracting resets."""
    resets = resets_between(("m0", "m1", [["1/2", 0]]), ("m1", "m0", [["1/2"], [0]]))
    return family([[0, 1], [-3, -1]], [[-1]], switching=Switching(resets=resets))


def slow_switching_in_steps() -> SwitchedSystem:
    """Discrete time: alternating grows with up to four steps in each mode, from five on not."""
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    return family(*pair, time=Time.DISCRETE, switching=Switching(Fraction(6)))


def must_leave(longest: int, **rules: object) -> SwitchedSystem:
    """Discrete time: x doubles in m0, for so many steps at most, and is an eighth after one in m1.

    So it grows iff ``2^longest > 8``, by the slowest cycle: longest steps in m0 and one in m1.
    """
    stays = (("m0", Stay(Fraction(1), Fraction(longest))),)
    return family([[2]], [["1/8"]], time=Time.DISCRETE, switching=Switching(stays=stays, **rules))


def must_leave_in_time(rest: Entry) -> SwitchedSystem:
    """Continuous time: x grows by e^t in m0, for 1/2 to 1 s, and decays by e^-t in m1.

    Stable iff m1 lasts for more than 1 s.
    """
    stays = (("m0", Stay(Fraction(1, 2), Fraction(1))), ("m1", Stay(Fraction(rest))))
    return family([[1]], [[-1]], switching=Switching(stays=stays))


def two_ways(gain: Entry) -> SwitchedSystem:
    """Discrete time: both modes halve the state, and of two resets one multiplies by the gain."""
    resets = resets_between(("m0", "m1", [["1/2"]]), ("m0", "m1", [[gain]]))
    return family([["1/2"]], [["1/2"]], time=Time.DISCRETE, switching=Switching(resets=resets))


PAIR = Switching(fixed_ends=(("m0", "m1"),))
PAIRS = Switching(fixed_ends=(("m0", "m1"), ("m2", "m3")))


def hidden_value(strength: Entry, time: Time = Time.CONTINUOUS) -> SwitchedSystem:
    """``A(s) = [[-1, c s], [c (1 - s), -1]]``, s unknown but constant in [0, 1].

    Its eigenvalues are ``-1 +- c sqrt(s (1 - s))``: Hurwitz at both ends, and for all s iff c < 2.
    In discrete time without the diagonal: Schur at both ends, and for all s iff c < 2.
    """
    diagonal = -1 if time is Time.CONTINUOUS else 0
    ends = [[diagonal, 0], [strength, diagonal]], [[diagonal, strength], [0, diagonal]]
    return family(*ends, time=time, switching=PAIR)


def hidden_shears(time: Time = Time.CONTINUOUS) -> SwitchedSystem:
    """Two shears, one growing with the parameter and one shrinking.

    Every mode is stable at every value. At both ends one shear is gone, so that switching is
    stable; in between the average has the eigenvalue ``-1 + 5 sqrt(s (1 - s))``. In discrete time
    the product of the two has a radius above one.
    """
    diagonal = "-1" if time is Time.CONTINUOUS else "1/2"
    rest = [[diagonal, 0], [0, diagonal]]
    up, down = [[diagonal, 10], [0, diagonal]], [[diagonal, 0], [10, diagonal]]
    return family(rest, up, down, rest, time=time, switching=PAIRS)


def lossy_network(scale: Entry = 1) -> SwitchedSystem:
    """Stable by degree 4 and by no quadratic functions (Philippe et al. 2016, section 4)."""
    s, gains = Fraction(scale), (("0", "0.27"), ("-0.49", "0"), ("-0.49", "0.27"), ("0", "0"))
    matrices = [
        [
            [s * Fraction("0.94"), s * Fraction("0.56")],
            [s * (Fraction("0.14") + Fraction(k1)), s * (Fraction("0.46") + Fraction(k2))],
        ]
        for k1, k2 in gains
    ]
    # Only node 3 has an edge to itself; the others are left after one step.
    one = Stay(Fraction(1), Fraction(1))
    edges = ("12", "21", "13", "31", "23", "32", "34", "43")
    switching = Switching(
        transitions=tuple((f"n{a}", f"n{b}") for a, b in edges),
        stays=tuple((name, one) for name in ("n1", "n2", "n4")),
    )
    names = ("n1", "n2", "n3", "n4")
    return family(*matrices, time=Time.DISCRETE, switching=switching, names=names)


def bouncing(damping: Entry = 0) -> SwitchedSystem:
    """A mass on a viscous ground and a spring, of stiffness 1 to 2, that pushes only.

    ``v' = -2 v - k delta - b v`` in contact and ``v' = -2 v`` free. With damping b, the
    environment could pull.
    """
    b = Fraction(damping)
    contact = [[[-2 - b, -k], [1, 0]] for k in (1, 2)]
    pulls = tuple(matrix([[b, k]]) for k in (1, 2)) if b else ()
    free = Mode("free", matrix([[-2, 0], [1, 0]]))
    return replace(family(*contact), contact=Contact((free,), pulls))


def sucking_in() -> SwitchedSystem:
    """A mass that what it touches draws in: its contact grows along ``v = delta``, never lost."""
    free = Mode("free", matrix([[-1, 0], [1, 0]]))
    system = family([[-1, 2], [1, 0]])
    return replace(system, contact=Contact((free,), required=True))


def sucking_in_steps(damping: Entry = 0) -> SwitchedSystem:
    """The same in steps; with damping, its force is one of the deflection and of the speed."""
    b = Fraction(damping)
    free = Mode("free", matrix([["1/2", 0], [1, 1]]))
    pulls = (matrix([[b, 1]]), matrix([[b, 2]])) if b else ()
    system = family([["1/2", "1/4"], [1, 1]], time=Time.DISCRETE)
    return replace(system, contact=Contact((free,), pulls, required=True))


def juggling() -> SwitchedSystem:
    """A loop that grows by 1.9 in every step of contact with one of flight, and in no mode alone.

    In kept contact it would grow with a deflection that changes its sign.
    """
    free = matrix([["-4/5", "9/10", 0], ["1/10", "1/2", 0], ["9/10", 0, 1]])
    contact = [["-4/5", "9/10", "8/5"], ["1/10", "1/2", "-11/10"], ["9/10", 0, 1]]
    system = family(contact, time=Time.DISCRETE)
    return replace(system, contact=Contact((Mode("free", free),), required=True))


def juggling_among_modes() -> SwitchedSystem:
    system = juggling()
    assert system.contact is not None
    flights = Flights(("m0",), ("free",))
    modes = (*system.modes, *system.contact.free)
    return replace(system, modes=modes, contact=None, flights=flights)


def juggling_in_turns() -> SwitchedSystem:
    """The same, with modes of the same matrices that take turns at every second step."""
    system = juggling()
    assert system.contact is not None
    ((mode,), (free,)) = system.modes, system.contact.free
    modes, flying = ((m, replace(m, name=f"{m.name} again")) for m in (mode, free))
    contact = replace(system.contact, free=flying)
    return replace(system, modes=modes, contact=contact, clock=Clock(2, ("m0", "free")))


def drifting() -> SwitchedSystem:
    free = Mode("free", matrix([[1, 0], [1, 0]]))
    return replace(family([[-2, -1], [1, 0]]), contact=Contact((free,), required=True))


def cut_off(
    name: str, limit: Entry, column: Rows, row: Rows, modes: int = 1, **more: object
) -> CutOff:
    """Cut a signal off at a limit that is the same in so many modes."""
    columns, rows = (matrix(column),) * modes, (matrix(row),) * modes
    return CutOff(name=name, unit="N", limit=Fraction(limit), columns=columns, rows=rows, **more)


def saturating() -> SwitchedSystem:
    """The same mass, pushed by ``v' = v + s1 + s2`` on a ground that does not slow it.

    ``s1 = sat(-v)``, cut off at 2, and ``s2 = sat(s1 - v)``, cut off at 1: from ``v = 3`` on it
    flies away.
    """
    signals = (
        cut_off("s1", 2, [[1], [0]], [[-1, 0]], 3),
        cut_off("s2", 1, [[1], [0]], [[-1, 0, 1]], 3),
    )
    start = Start("force", "N", tuple(matrix([[0], [Fraction(1, k)]]) for k in (1, 2)))
    return replace(bouncing(), saturation=Saturation(signals, start))


def kept(system: SwitchedSystem) -> SwitchedSystem:
    """Take the free mode out of a system of which signals saturate."""
    assert system.saturation is not None
    count = len(system.modes)
    signals = tuple(
        replace(s, columns=s.columns[:count], rows=s.rows[:count])
        for s in system.saturation.signals
    )
    return replace(system, contact=None, saturation=replace(system.saturation, signals=signals))


def pushed_away(pull: Entry = 3) -> SwitchedSystem:
    """``x' = x + sat(-pull x)``, cut off at 1: it decays from ``|x| < 1`` exactly."""
    signal = cut_off("s", 1, [[1]], [[-Fraction(pull)]])
    start = Start("place", "m", (matrix([[1]]),))
    system = family([[1 - Fraction(pull)]])
    return replace(system, saturation=Saturation((signal,), start))


def pushed_away_in_steps() -> SwitchedSystem:
    """``x+ = 3/2 x + sat(-x)``, cut off at 1: it decays from ``|x| < 2`` exactly."""
    signal = cut_off("s", 1, [[1]], [[-1]])
    start = Start("place", "m", (matrix([[1]]),))
    system = family([["1/2"]], time=Time.DISCRETE)
    return replace(system, saturation=Saturation((signal,), start), sample_time=Fraction(1, 10))


def saturating_in_steps() -> SwitchedSystem:
    """A mass that bounces in steps, of which ``v+ = 11/10 v + sat(-3/10 v)``, cut off at 1/2.

    What makes the push is rounded.
    """
    system = bouncing_in_steps()
    column, row = [[1], [0]], [["-3/10", 0]]
    rounding = Rounding("s", (matrix(column),) * 3, (matrix([["3/10000", 0]]),) * 3)
    signal = cut_off("s", "1/2", column, row, 3, errors=(matrix([[1]]),) * 3)
    start = Start("force", "N", tuple(matrix([[0], [Fraction(1, k)]]) for k in (1, 2)))
    return replace(system, roundings=(rounding,), saturation=Saturation((signal,), start))


def bouncing_in_steps(damping: Entry = 0) -> SwitchedSystem:
    b = Fraction(damping)
    contact = [[[(8 - b) / 10, Fraction(-k, 10)], ["1/10", 1]] for k in (1, 2)]
    pulls = tuple(matrix([[b, k]]) for k in (1, 2)) if b else ()
    free = Mode("free", matrix([["4/5", 0], ["1/10", 1]]))
    system = family(*contact, time=Time.DISCRETE)
    return replace(system, contact=Contact((free,), pulls), sample_time=Fraction(1, 10))


def losable(contact: Rows, free: Rows, time: Time, *pulls: Rows) -> SwitchedSystem:
    rows = tuple(matrix(q) for q in pulls)
    return replace(family(contact, time=time), contact=Contact((Mode("f", matrix(free)),), rows))


def over(denominator: int, *rows: tuple[int, ...]) -> Rows:
    return [[Fraction(entry, denominator) for entry in row] for row in rows]


# Functions that rise from a state that lags, and keep all conditions but one. The multipliers are
# lambda, mu where the deflection stays, mu and lambda where it does not.
LAGGING = {
    "while the environment lags, mode f": (
        losable(over(8, (-4, 9), (3, 3)), over(8, (-1, 0), (5, 8)), Time.DISCRETE, [[-6, 1]]),
        ((512, -320), (-320, 720)),
        (16, 0, 16, 16),
    ),
    "where a lagging environment is left, mode f": (
        losable(over(8, (6, -1), (-8, -2)), over(8, (-7, 0), (5, 8)), Time.DISCRETE, [[1, 4]]),
        ((384, 336), (336, 400)),
        (256, 128, 0, 0),
    ),
}


def bouncing_in_turns(damping: Entry = 0, rounded: bool = False) -> SwitchedSystem:
    """The same, with a force that acts twice as much at every second step, and then not at all.

    Only at the steps in between the velocity decays.
    """
    b, share = Fraction(damping), Fraction(1, 1000)
    acts = [[[1 - b / 5, Fraction(-k, 5)], ["1/10", 1]] for k in (1, 2)]
    rest, fall = [["3/5", 0], ["1/10", 1]], [[1, 0], ["1/10", 1]]
    names = ("push 1", "push 2", "rest")
    system = family(*acts, rest, time=Time.DISCRETE, names=names)
    free = Mode("fall", matrix(fall)), Mode("fall on", matrix(rest))
    pulls = tuple(matrix([[b, k]]) for k in (1, 2)) if b else ()
    rounding = Rounding("F", (matrix([[1], [0]]),) * 5, (matrix([[share, 0]]),) * 5)
    return replace(
        system,
        contact=Contact(free, pulls),
        roundings=(rounding,) if rounded else (),
        clock=Clock(2, ("push 1", "push 2", "fall")),
    )


def doubled_in_turns(length: int, gain: Entry = 2) -> SwitchedSystem:
    """x doubles at the first step of a round, and is multiplied by three quarters at all others."""
    system = family([[gain]], [["3/4"]], time=Time.DISCRETE)
    return replace(system, clock=Clock(length, ("m0",)))


def pushed(system: SwitchedSystem, push: Entry = "1/4") -> SwitchedSystem:
    """A bouncing mass that is pushed, with its force on a spring of 1 to 2."""
    step = system.sample_time or Fraction(1)
    column = matrix([[step], [0]])
    free = () if system.contact is None else system.contact.free
    count = len(system.modes) + len(free)
    rows = (matrix([[0, 1]]), matrix([[0, 2]]))
    return replace(
        system,
        channels=(Channel("push", "N", Fraction(push), (column,) * count),),
        outputs=(Output("force", "N", rows, Fraction(1)),),
    )


def left_within(*stays: tuple, **rules: object) -> Switching:
    """Rules with a shortest and a longest stay for the first modes."""
    named = (
        (f"m{k}", Stay(Fraction(first), None if last is None else Fraction(last)))
        for k, (first, last) in enumerate(stays)
    )
    return Switching(stays=tuple(named), **rules)


def crowded(time: Time, *, lost: bool = True, pulled: bool = True) -> SwitchedSystem:
    """Several of everything that an axis which may lose contact can have, of any numbers.

    No two numbers have a reason to be equal: what is mistaken for something else shows.
    """
    rng, count = Random(5), 4 if lost else 2

    def drawn(n: int, m: int) -> RationalMatrix:
        numbers = [Fraction(k, d) for k in (-7, -4, -1, 1, 2, 5) for d in (1, 2, 3)]
        return matrix([[rng.choice(numbers) for _ in range(m)] for _ in range(n)])

    def each(n: int, m: int) -> tuple[RationalMatrix, ...]:
        return tuple(drawn(n, m) for _ in range(4))[:count]

    free, corner = [drawn(3, 2).fractions() for _ in range(2)], int(time is Time.DISCRETE)
    flights = ([[*row, k == 2 and corner] for k, row in enumerate(rows)] for rows in free)
    bounds = zip(("push", "gust", "jerk"), ("1/3", "7", "5/2"), strict=True)
    # In free motion, what is rounded is nothing of the deflection.
    sizes = [[drawn(1, 6).fractions()[0] for _ in range(4)] for _ in ("u", "v")]
    rows = [
        tuple(matrix([[*q[:2], q[2] * (k < 2), *q[3:]]]) for k, q in enumerate(own[:count]))
        for own in sizes
    ]
    roundings = (Rounding(name, each(3, 1), own) for name, own in zip("uv", rows, strict=True))
    motions = tuple(Mode(f"f{k}", matrix(A)) for k, A in enumerate(flights))
    pulls = (drawn(1, 3), drawn(1, 3))
    return replace(
        family(drawn(3, 3).fractions(), drawn(3, 3).fractions(), time=time),
        contact=Contact(motions, pulls if pulled else ()) if lost else None,
        channels=tuple(Channel(name, "N", Fraction(size), each(3, 1)) for name, size in bounds),
        outputs=(
            Output("speed", "m/s", (drawn(1, 3),)),
            Output("force", "N", (drawn(1, 3), drawn(1, 3))),
        ),
        roundings=tuple(roundings) if corner else (),
    )


def one_way() -> SwitchedSystem:
    return dayawansa_martin(12, switching=Switching(transitions=(("m0", "m1"),)))


def circling() -> SwitchedSystem:
    return family([[0, 1], [-1, 0]])


def missed() -> SwitchedSystem:
    system = family([["1/2"]], [["3/2"]], time=Time.DISCRETE)
    return replace(system, clock=Clock(2, ("m0",), ((0, 1), (0, NOWHERE))))


def in_kept_contact(system: SwitchedSystem) -> SwitchedSystem:
    return replace(system, contact=None)


def turns_in_kept_contact() -> SwitchedSystem:
    clock = Clock(2, ("push 1", "push 2"))
    return replace(bouncing_in_turns(), contact=None, clock=clock)


def built(said: str | list[Any]) -> SwitchedSystem:
    """Return what a function of this file makes of arguments; of lists, what is made first."""
    name, *arguments = [said] if isinstance(said, str) else said
    times = {time.value: time for time in Time}
    made_first = (
        built(item) if isinstance(item, list) else times.get(item, item) for item in arguments
    )
    return globals()[name](*made_first)


# Of each example, a system and maybe the method that finds its evidence.
EXAMPLES = table(Path(__file__).with_suffix(".yaml"))
SYSTEMS = {name: partial(built, said) for name, said in EXAMPLES["systems"].items()}


@cache
def genuine(example: str) -> tuple[SwitchedSystem, AbstractEvidence]:
    """Return a system and evidence of a kind, or a graph of a shape, that the search finds."""
    system, kind = SYSTEMS[example](), example.split(",")[0]
    if kind == "invariant-ellipsoid":  # Where contact may be lost, one off the origin comes first.
        with floats_in_silence():
            search = search_ellipsoid(system, system.channels, system.outputs[0], Allowance())
            evidence, _ = first_accepted(search, system)
        assert evidence is not None
        return system, evidence
    found = certify(
        system, Method(EXAMPLES["methods"].get(example, "auto")), Limits(optimize_rate=False)
    )
    return system, next(item for item in found.statements if shape_of(item) == kind)


def expect(system: SwitchedSystem, evidence: AbstractEvidence, fault: str | None) -> None:
    """Check that evidence holds (None), or that its fault has these words."""
    found = evidence.find_fault(system)
    assert (found is None) is (fault is None), found
    assert fault is None or found is None or fault in found, found
