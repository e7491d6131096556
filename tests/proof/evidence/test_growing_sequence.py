"""A closed sequence that grows: published limits, what is admissible, known answers, attacks."""

from contextlib import nullcontext
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.certificates.certificate import (
    CommonQuadraticStatus,
    common_quadratic_of,
    granted,
    refuted_in,
    refutes_in_contact,
    verdict_of,
)
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.enclosure import precision
from nrs_design.proof.evidence import GrowingSequence, Shows, read_evidence
from nrs_design.proof.evidence.growing_sequence import (
    MAX_FACTOR_DENOMINATOR,
    MAX_STEPS,
    decides,
    staying,
)
from nrs_design.proof.evidence.growth import monodromy
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.proof.switching import Clock, FixedParameter, Reset, Stay, Switching
from nrs_design.search.certify import Verdict
from tests.proof.systems import (
    PAIR,
    PAIRS,
    bouncing_in_steps,
    branicky,
    drifting,
    expect,
    family,
    genuine,
    hidden_shears,
    hidden_value,
    juggling,
    juggling_among_modes,
    juggling_in_turns,
    matrix,
    must_leave,
    resets_between,
    shears,
    sucking_in,
    sucking_in_steps,
    two_ways,
)
from tests.proof.truth import holds
from tests.support import ends_soon, is_stable_by_lyapunov

HALF = Fraction(1, 2)


STEPS, SECONDS = Time.DISCRETE, Time.CONTINUOUS
ONE = Fraction(1)


def at(share, part):
    return replace(part, shares=(share,))


def in_contact(steps, factor):
    return GrowingSequence(tuple((name, Fraction(k)) for name, k in steps), factor=factor)


def mixed(*weights):
    return GrowingSequence(tuple((f"m{i}", Fraction(w)) for i, w in enumerate(weights)))


def signal(*steps, doublings=20):
    named = tuple((f"m{mode}", Fraction(dwell)) for mode, dwell in steps)
    return GrowingSequence(named, doublings)


def under(switching, *matrices, **more):
    return family(*matrices, switching=switching, **more)


UP, DOWN, FADING = [[1, 0], [0, 1]], [[1, 0], [1, 1]], [[-1, 0], [0, -1]]
UNSTABLE, GROWING = family(UP), family([[1, 1], [0, 1]], DOWN, time=STEPS)
BOTH = mixed(HALF, HALF)
THIRD = Fraction(2**63 + 1, 2**64)
RULES = (
    Switching(dwell_time=Fraction(10**6)),
    Switching(transitions=()),
    Switching(resets=(Reset("m0", "m1", matrix([[0, 0], [0, 0]])),)),
    Switching(fixed_ends=(("m0", "m1"),)),
)
ENDLESS = family([[0, 1], [-1, 0]])
BARELY, BELOW = (family([[rate, 0], [0, "1/2"]], time=STEPS) for rate in ("1.0000001", "0.9999999"))
NINE = resets_between(("m1", "m0", [[9, 0], [0, 9]]))
STAYING = under(Switching(resets=resets_between(("m0", "m0", [[9, 0], [0, 9]]))), FADING, FADING)
TURNS = signal((0, "0.5"), (1, "0.5"))
NOT_SHOWN = "the enclosure of the monodromy matrix does not show growth"
HUNDRED = family([[int(i == j) for j in range(100)] for i in range(100)], time=STEPS)
LONGEST = signal(*[(0, 1), (1, 1)] * 512, doublings=0)


@pytest.mark.parametrize(
    ("system", "evidence", "fault"),
    [
        # Unknown and ambiguous modes refute nothing.
        (UNSTABLE, staying("m0"), None),
        (UNSTABLE, staying("m1"), "do not exist"),
        (replace(UNSTABLE, modes=UNSTABLE.modes * 2), staying("m0"), "same name"),
        # No rule of switching forces a signal to leave its mode.
        *((under(rules, UP, FADING), staying("m0"), None) for rules in RULES),
        *((under(rules, UP, FADING), staying("m1"), "stable") for rules in RULES),
        # [[-1, s], [s, -1]] with s = 1 has the eigenvalue 0: not Hurwitz, so not uniformly stable.
        (family([[-1, 2], [0, -1]], [[-1, 0], [2, -1]]), BOTH, None),
        (family([[-1, "1.999999"], [0, -1]], [[-1, 0], ["1.999999", -1]]), BOTH, "stable"),
        # Names are those of modes and occur once, even where the mode named twice is not stable.
        *(
            (shears(), GrowingSequence(tuple((name, HALF) for name in names)), "")
            for names in (("m0", "m0"), ("m0", "m7"))
        ),
        (
            family([[1]], [[-1]]),
            GrowingSequence((("m0", HALF), ("m0", HALF))),
            "a mode is named twice in an average",
        ),
        (shears(), GrowingSequence((("m9", ONE),)), "do not exist"),
        # An average needs arbitrarily fast switching.
        *(
            (shears(rules), BOTH, "switching")
            for rules in (
                Switching(Fraction(1, 10**9)),
                Switching(transitions=(("m0", "m1"), ("m1", "m0"))),
                Switching(resets=resets_between(("m0", "m1", UP))),
                RULES[-1],
            )
        ),
        # The average of these is not Schur, yet every product of two of them is zero or small.
        (
            family([["1/2", 8], [0, "1/2"]], [["1/2", 0], [8, "1/2"]], time=STEPS),
            BOTH,
            "continuous",
        ),
        # A spectral radius of exactly one is no growth.
        *((ENDLESS, signal((0, "1.5"), doublings=k), "") for k in range(0, 61, 6)),
        *((replace(ENDLESS, time=STEPS), signal((0, 1), doublings=k), "") for k in range(0, 61, 6)),
        (family([[1, 1], [0, 1]], time=STEPS), signal((0, 1), doublings=60), ""),
        # One barely above it needs many doublings.
        (BARELY, signal((0, 1), doublings=2), NOT_SHOWN),
        (BARELY, signal((0, 1), doublings=30), None),
        *((BELOW, signal((0, 1), doublings=k), NOT_SHOWN) for k in range(61)),
        # Growth that a second opinion would never end with.
        (family([[1000]]), signal((0, 1)), None),
        (family([[10**20]]), signal((0, 1)), "mode m0 grows too far to check"),
        # Resets at the switch back to the first mode count; two steps of a mode are a longer stay.
        (under(Switching(resets=NINE), FADING, FADING), TURNS, None),
        (family(FADING, FADING), TURNS, NOT_SHOWN),
        (STAYING, TURNS, ""),
        (STAYING, signal((0, "0.5"), (0, "0.5")), ""),
        # The longest signal, and the most work.
        (GROWING, LONGEST, None),
        (GROWING, replace(LONGEST, steps=(*LONGEST.steps, ("m0", ONE))), "does not cover"),
        (HUNDRED, signal(*[(0, 1)] * 5, doublings=0), NOT_SHOWN),
        (
            HUNDRED,
            signal(*[(0, 1)] * 6, doublings=0),
            "the sequence is too long for so many states",
        ),
        *(
            (GROWING, signal((0, 1), (1, 1), doublings=k), fault)
            for fault, numbers in (
                (None, (0, 60)),
                ("the trace is not that of a power up to 60 doublings", (-1, 61)),
            )
            for k in numbers
        ),
        # Of diag(g, 0), g to the power 2^k is compared to two.
        *(
            (family([[growth, 0], [0, 0]], time=STEPS), signal((0, 1), doublings=k), fault)
            for growth, k, fault in (
                ("3", 0, None),
                ("2", 0, NOT_SHOWN),
                ("-3", 0, None),
                ("7/4", 0, NOT_SHOWN),
                ("7/4", 1, None),
            )
        ),
    ],
)
def test_what_is_shown_of_modes_averages_and_periods(system, evidence, fault):
    expect(system, evidence, fault)


@pytest.mark.parametrize(
    "weights", [(HALF,), (1, 1), (0, 1), (Fraction(3, 2), -HALF), (), (HALF, HALF, 0)]
)
def test_weights_are_positive_with_sum_one(weights):
    rows = [mode.A.fractions() for mode in shears().modes]
    expect(family(*rows, rows[0]), mixed(*weights), "")


LONG = ((1, 0), (0, 1)), ((2**400_000, 1), (0, 1))
TOO_LARGE = "the numbers of the average of the modes are too large to check"


@pytest.mark.parametrize(
    ("system", "evidence", "fault", "error"),
    [
        (shears(), mixed(THIRD, 1 - THIRD), None, None),
        (
            shears(),
            mixed(HALF + Fraction(1, 2**64 + 1), HALF - Fraction(1, 2**64 + 1)),
            "the weights have too many digits",
            TooLargeError,
        ),
        (
            family([[1]], [[-1]]),
            GrowingSequence((("m0", Fraction(1, 3)),) * 3),
            "a mode is named twice in an average",
            TooLargeError,
        ),
        (shears(), GrowingSequence((("m9", ONE),)), "do not exist", KeyError),
        *(
            (
                replace(shears(), modes=tuple(Mode(f"m{i}", A) for i, A in enumerate(matrices))),
                BOTH,
                TOO_LARGE,
                (ValueError, TooLargeError),
            )
            for matrices in (
                (RationalMatrix(LONG[0], 2**60_000), RationalMatrix(LONG[0], 3**40_000)),
                (RationalMatrix(LONG[1]), RationalMatrix(LONG[0])),
            )
        ),
    ],
    ids=("short", "long", "thrice", "unknown", "coprime", "large"),
)
def test_what_is_read_is_said_in_words_before_it_is_checked(system, evidence, fault, error):
    expect(system, evidence, fault)
    with pytest.raises(error) if error else nullcontext():
        evidence.claim(system)


@settings(deadline=None)
@given(st.lists(st.integers(-6, 6), min_size=9, max_size=9), st.sampled_from(list(Time)))
def test_against_the_lyapunov_equation(entries, time):
    """Another algorithm, without a characteristic polynomial."""
    rows = [[Fraction(e, 5) for e in entries[i : i + 3]] for i in (0, 3, 6)]
    system = family(rows, time=time)
    stable = is_stable_by_lyapunov(rows, discrete=time is Time.DISCRETE)
    assert is_stable(system.modes[0].A, time) is stable
    evidence = staying("m0")
    assert (evidence.find_fault(system) is None) is not stable
    assert holds(system, evidence) is not stable


def test_words_and_fields():
    evidence, system = staying("m0"), family([[2]])
    assert evidence.shows is Shows.INSTABILITY
    assert evidence.proved_rate(system) is None
    assert evidence.claim(system) == (
        "Mode m0 is not Hurwitz (eigenvalue about 2): staying in it is an admissible switching "
        "signal, so x' = A x is not uniformly exponentially stable."
    )
    assert evidence.to_fields() == {"steps": [["m0", "1"]]}
    assert GrowingSequence.from_fields(evidence.to_fields(), system) == evidence


def test_a_mode_that_must_be_left_refutes_nothing():
    stays = (("m0", Stay(Fraction(1), Fraction(3))),)
    system = family([[2]], [["1/8"]], time=Time.DISCRETE)
    system = replace(system, switching=Switching(stays=stays))
    evidence = staying("m0")
    assert evidence.find_fault(replace(system, switching=Switching(Fraction(3)))) is None
    assert "does not cover this kind of switching" in evidence.find_fault(system)
    assert not holds(system, evidence)


def test_the_order_of_time_is_that_of_the_steps():
    # From m0 to m1 the state is swapped, back it is left: only the order tells which is first.
    resets = resets_between(("m0", "m1", [[0, 1], [0, 0]]))
    system = family(
        [[2, 0], [0, "1/2"]],
        [["1/2", 0], [0, 4]],
        time=Time.DISCRETE,
        switching=Switching(resets=resets),
    )
    before, ctx.prec = ctx.prec, 100
    try:
        product = monodromy(system, signal((0, 1), (1, 1)).steps)
    finally:
        ctx.prec = before
    expected = np.diag([0.5, 4]) @ np.array([[0, 1], [0, 0]]) @ np.diag([2, 0.5])
    found = [[float(product[i, j]) for j in range(2)] for i in range(2)]
    assert np.array_equal(np.array(found), expected)


def test_one_value_of_a_constant_parameter_refutes():
    rows = [mode.A.fractions() for mode in branicky().modes]
    system = family(
        rows[0], rows[1], rows[0], rows[1], switching=Switching(
            fixed_ends=(("m0", "m2"), ("m1", "m3"))
        )
    )  # fmt: skip
    _, evidence = genuine("growing-sequence, period")
    assert evidence.find_fault(system) is None
    crossed = replace(evidence, steps=tuple(
        ({"m1": "m3"}.get(name, name), dwell) for name, dwell in evidence.steps
    ))  # fmt: skip
    assert crossed.find_fault(system) is not None


def test_enormous_modes_do_not_hang_or_overflow():
    for time in Time:
        system = family([[-(10**200), 10**200], [-(10**200), -1]], time=time)
        with ends_soon():
            signal((0, 4096), doublings=60).find_fault(system)


def test_a_stay_longer_than_the_longest_refutes_nothing():
    # Four steps in m0 and one in m1 double the state; three leave it as it is.
    grows = signal((0, 4), (1, 1))
    assert grows.find_fault(must_leave(4)) is None
    assert holds(must_leave(4), grows)
    assert "does not cover" in grows.find_fault(must_leave(3))
    assert not holds(must_leave(3), grows)


@pytest.mark.parametrize(
    "steps", [[(0, 2), (0, 2), (1, 1)], [(0, 2), (1, 1), (0, 2)], [(0, 1)], [(0, 2), (0, 2)]]
)
def test_a_stay_cannot_be_split(steps):
    # Round the period, two steps of one mode in turn are one stay, and one alone never ends.
    evidence = signal(*steps)
    for longest in (3, 4):
        assert "does not cover" in evidence.find_fault(must_leave(longest))
        assert not holds(must_leave(longest), evidence)


def test_the_reset_that_is_taken_is_in_the_file():
    system, evidence = genuine("growing-sequence, two ways")
    fields = {"kind": evidence.kind, **evidence.to_fields()}
    assert fields["edges"] == [1, 0]
    assert "then reset 2 to m1, m1 for 1 steps)" in evidence.claim(system)
    assert read_evidence(fields, system) == evidence
    with pytest.raises(ValueError, match="one edge for each"):
        read_evidence({**fields, "edges": [1]}, system)
    assert "edges" not in genuine("growing-sequence, period")[1].to_fields()


def test_an_empty_or_too_long_signal_fits_no_system():
    for steps in ((), (*LONGEST.steps, ("m0", ONE))):
        misfit = replace(LONGEST, steps=steps).find_misfit(GROWING)
        assert misfit == "the sequence is empty or too long"


def test_the_most_work(monkeypatch):
    limit = "nrs_design.proof.evidence.growing_sequence.MAX_WORK"
    evidence, system = signal((0, 1), (1, 1), doublings=2), GROWING
    monkeypatch.setattr(limit, 2 * 2**3)
    assert evidence.find_fault(system) is None
    monkeypatch.setattr(limit, 2 * 2**3 - 1)
    assert evidence.find_fault(system) == "the sequence is too long for so many states"


@pytest.mark.parametrize(
    ("dwell", "time", "fault"),
    [
        ("4096", SECONDS, None),
        ("4096", STEPS, None),
        ("4097", STEPS, "a time is not between 0 and 4096"),
        ("8193/2", SECONDS, "a time is not between 0 and 4096"),
        ("0", SECONDS, "a time is not between 0 and 4096"),
        ("1/2", SECONDS, None),
        ("1/2", STEPS, "a number of steps is not whole"),
        ("3/2", STEPS, "a number of steps is not whole"),
        ("1", STEPS, None),
    ],
)
def test_dwell_times_between_the_limits(dwell, time, fault):
    system = family([[2]], time=time)
    assert signal((0, dwell), doublings=4).find_misfit(system) == fault
    if time is SECONDS:
        assert signal((0, 1), (0, dwell), doublings=4).find_misfit(system) == fault


@pytest.mark.parametrize(
    ("dwell", "shortest", "longest", "fits"),
    [
        (2, 2, None, True),
        (1, 2, None, False),
        (2, 2, 2, True),
        (2, 1, 3, True),
        (1, 2, 3, False),
        (4, 2, 3, False),
    ],
)
def test_how_long_a_mode_may_stay(dwell, shortest, longest, fits):
    stay = Stay(Fraction(shortest), longest and Fraction(longest))
    evidence = signal((0, dwell), (1, 1))
    assert evidence.fits(Switching(stays=(("m0", stay),))) is fits


@pytest.mark.parametrize(
    ("steps", "transitions", "fits"),
    [
        ([(0, 1), (1, 1)], (("m0", "m1"), ("m1", "m0")), True),
        ([(0, 1), (1, 1)], (("m0", "m1"),), False),
        ([(0, 1), (1, 1), (2, 1)], (("m0", "m1"), ("m1", "m2"), ("m2", "m0")), True),
        ([(0, 1), (1, 1), (2, 1)], (("m0", "m1"), ("m1", "m2"), ("m0", "m2")), False),
        ([(0, 1), (0, 1), (1, 1)], (("m0", "m1"), ("m1", "m0")), True),
        ([(0, 1)], (), True),
        ([], (), False),
    ],
)
def test_switches_that_are_allowed(steps, transitions, fits):
    assert signal(*steps).fits(Switching(transitions=transitions)) is fits


def test_a_mode_of_no_end_is_at_no_value():
    ends = Switching(fixed_ends=(("m0", "m1"), ("m2", "m3")))
    for modes, fits in (((0, 2), True), ((1, 3), True), ((0, 3), False), ((0, 4), False)):
        assert signal(*((mode, 1) for mode in modes)).fits(ends) is fits


def test_every_step_takes_its_own_reset():
    """Of two resets one doubles and one triples; the way back has none."""
    resets = resets_between(("m0", "m1", [[2]]), ("m0", "m1", [[3]]))
    system = family([[1]], [["1/5"]], time=STEPS, switching=Switching(resets=resets))
    steps = signal((0, 1), (1, 1), (0, 1), (1, 1)).steps
    for edges, factor in (((0, 0, 0, 0), 4), ((1, 0, 0, 0), 6), ((1, 0, 1, 0), 9)):
        with precision():
            assert monodromy(system, steps, edges)[0, 0].contains(arb(fmpq(factor, 25)))
    for edges, fits in (
        ((1, 0, 0, 0), True),
        ((1, 0, 1, 0), True),
        ((2, 0, 0, 0), False),
        ((0, 0, 2, 0), False),
        ((0, 1, 0, 0), False),
        ((0, -1, 0, 0), False),
        ((0, 0, 0), False),
        ((0, 0, 0, 0, 0), False),
        ((), False),
    ):
        assert GrowingSequence(steps, 3, edges).fits(system.switching) is fits
    one = Switching(resets=resets[:1])
    assert GrowingSequence(steps, 3).fits(one)
    assert GrowingSequence(steps, 3).fits(Switching())


def test_claims():
    ways = two_ways(5)
    resets = GrowingSequence((("m0", Fraction(1)), ("m1", Fraction(2))), 6, (1, 0)).claim(ways)
    assert resets == (
        "Repeating the signal (m0 for 1 steps, then reset 2 to m1, m1 for 2 steps) makes some "
        "solution grow without bound: the spectral radius over one period is above 1, so "
        "x+ = A x is unstable under this switching."
    )
    first = GrowingSequence((("m0", Fraction(1)), ("m1", Fraction(2))), 6).claim(ways)
    assert "(m0 for 1 steps, then reset 1 to m1, m1 for 2 steps)" in first
    one = replace(ways, switching=Switching(resets=ways.switching.resets[:1]))
    assert "(m0 for 1 steps, m1 for 2 steps)" in signal((0, 1), (1, 2)).claim(one)
    short = signal((0, "1/2"), (1, "1/4")).claim(branicky())
    assert "signal (m0 for 0.5 s, m1 for 0.25 s) makes" in short
    assert "so x' = A x is unstable" in short
    for times in (("1/3", "1/4"), ("1/4", "1/3")):
        long = signal(*enumerate(times)).claim(branicky())
        assert "about 0.333" in long
        assert "; the certificate holds the exact times) makes" in long


ONCE = (("m0", 1), ("free", 1))
NARROW = (Fraction(19416, 10000), Fraction(19417, 10000))
BOUNCE = in_contact(ONCE, NARROW)
NO_SIGNS = "the enclosure does not show a growing motion that keeps the signs of contact"


def test_one_step_of_contact_and_one_of_flight():
    system = juggling()
    assert BOUNCE.find_fault(system) is None
    assert BOUNCE.shown(system) is BOUNCE.shows is Shows.INSTABILITY
    assert verdict_of(system, (BOUNCE,)) is Verdict.REFUTED
    # Its modes in contact may share a function: nothing is said of that.
    assert common_quadratic_of(system, (BOUNCE,)) is CommonQuadraticStatus.UNKNOWN
    twice = in_contact(ONCE * 2, tuple(number**2 for number in NARROW))
    assert twice.find_fault(system) is None
    assert in_contact(ONCE[::-1], NARROW).find_fault(system) is None


@pytest.mark.parametrize(
    ("steps", "factor", "fault"),
    [
        # An eigenvalue that is not there, and others along which a sign is wrong.
        (ONCE, (Fraction(21, 10), Fraction(22, 10)), NO_SIGNS),
        ((("free", 1), ("free", 1)), NARROW, NO_SIGNS),
        ((("m0", 1), ("m0", 1)), NARROW, NO_SIGNS),
        ((("m0", 2), ("free", 1)), NARROW, NO_SIGNS),
        (ONCE, (Fraction(1), Fraction(2)), NO_SIGNS),
        # The same with an end that is no witness.
        (ONCE, (Fraction(99, 100), Fraction(2)), "not beyond the limit"),
        (ONCE, (NARROW[1], NARROW[0]), "not beyond the limit"),
        (ONCE, (NARROW[0], NARROW[0]), "not beyond the limit"),
        (ONCE, (NARROW[0], 2 - Fraction(1, MAX_FACTOR_DENOMINATOR + 1)), "too many digits"),
        ((), NARROW, "does not cover this kind of switching"),
        ((("m0", 0), ("free", 1)), NARROW, "a time is not between"),
        ((("m0", MAX_STEPS), ("free", 1)), NARROW, "too long for so many states"),
        ((("m0", 1), ("fre", 1)), NARROW, "modes that do not exist"),
    ],
)
def test_what_is_no_witness(steps, factor, fault):
    assert fault in in_contact(steps, factor).find_fault(juggling())


def test_the_signs_of_the_other_eigenvalue_count_for_themselves():
    """The sequence has a second eigenvalue beyond one, with an eigenvector of its own."""
    system = juggling()
    A, F = (np.array(m.A.floats()) for m in (*system.modes, *system.contact.free))
    values, vectors = np.linalg.eig(F @ A)
    for value, v in zip(values, vectors.T, strict=True):
        if not (abs(value.imag) < 1e-12 and value.real > 1):
            continue
        factor = (Fraction(value.real) - Fraction(1, 10**9), Fraction(value.real) + 1 / 10**9)
        factor = (factor[0], Fraction(factor[1]))
        keeps = v.real[-1] * (A @ v.real)[-1] < 0
        assert (in_contact(ONCE, factor).find_fault(system) is None) == keeps


def test_it_is_asked_for_only_where_the_loss_of_contact_must_be_covered():
    system = juggling()
    kept = replace(system, contact=replace(system.contact, required=False))
    assert "does not ask for the loss" in BOUNCE.find_fault(kept)
    assert "do not exist" in BOUNCE.find_fault(replace(system, contact=None))


def test_a_mode_that_draws_in():
    steps = in_contact((("m0", 1),), (Fraction(13, 10), Fraction(4, 3)))
    narrow = replace(steps, factor=(Fraction(13090, 10**4), Fraction(13091, 10**4)))
    assert narrow.find_fault(sucking_in_steps()) is None
    continuous = in_contact((("m0", 1),), (Fraction(999, 1000), Fraction(1001, 1000)))
    system = sucking_in()
    assert continuous.find_fault(system) is None
    assert "eigenvalue = 0.999 1/s" in continuous.claim(system)
    assert common_quadratic_of(system, (continuous,)) is CommonQuadraticStatus.IMPOSSIBLE
    longer = replace(continuous, steps=(("m0", 1), ("free", 1)))
    assert "one mode" in longer.find_fault(system)
    # A deflection along which it is the environment that would have to pull.
    pulling = Contact(system.contact.free, (matrix([[1, -2]]),), required=True)
    assert NO_SIGNS in continuous.find_fault(replace(system, contact=pulling))


def test_in_the_air_forces_may_all_pull_or_the_deflection_be_negative():
    system, evidence = genuine("growing-sequence, pulling")
    pulls = tuple(matrix([[-1, 0]]) for _ in range(2))
    assert NO_SIGNS in evidence.find_fault(
        replace(system, contact=replace(system.contact, pulls=pulls))
    )
    # A flight with a positive deflection, where the force of the moment would pull.
    free = Mode("free", matrix([["3/2", 0], [1, 1]]))
    lagging = replace(sucking_in_steps(), contact=Contact((free,), (matrix([[-2, 1]]),), True))
    flight = in_contact((("free", 1),), (Fraction(149, 100), Fraction(151, 100)))
    assert flight.find_fault(lagging) is None
    for pull in ([[-1, 1]], [[0, 1]]):
        other = replace(lagging, contact=replace(lagging.contact, pulls=(matrix(pull),)))
        # Downwards the deflection is negative: that is a flight, too.
        assert flight.find_fault(other) is None


def test_rules_of_switching_are_kept():
    system, evidence = genuine("growing-sequence, among modes")
    assert evidence.find_fault(system) is None
    for rules in (
        Switching(transitions=(("m0", "free"),)),
        Switching(dwell_time=Fraction(2)),
        Switching(stays=(("m0", Stay(Fraction(2))),)),
        Switching(resets=(Reset("m0", "free", matrix([[1, 0, 0], [0, 1, 0], [0, 0, 1]])),)),
    ):
        assert "does not cover" in evidence.find_fault(replace(system, switching=rules))
    forever = in_contact((("m0", 1),), NARROW)
    assert forever.fits(Switching(resets=(Reset("m0", "free", matrix([[1]])),)))
    assert not forever.fits(Switching(stays=(("m0", Stay(Fraction(1), Fraction(2))),)))
    both = Switching(transitions=(("m0", "free"), ("free", "m0")))
    assert evidence.find_fault(replace(system, switching=both)) is None


def test_modes_take_their_turns():
    system = juggling_in_turns()
    assert in_contact((("m0", 1), ("free again", 1)), NARROW).find_fault(system) is None
    assert "not its turn" in BOUNCE.find_fault(system)
    third = replace(system, clock=Clock(3, ("m0", "free")))
    late = in_contact((("m0", 1), ("free again", 1)), NARROW)
    assert "not its turn" in late.find_fault(third)


def test_words_and_fields_of_contact():
    system = juggling()
    assert BOUNCE.claim(system) == (
        "Repeating the sequence (m0 for 1 steps, free for 1 steps) makes some motion larger by a "
        "factor = 1.9416 each time. Wherever the environment acts, the deflection is positive "
        "along it and nothing pulls, and elsewhere it is not, so contact is lost and made as that "
        "motion says, and x+ = A x is unstable with contact that may be lost."
    )
    fields = BOUNCE.to_fields()
    assert fields == {"steps": [["m0", "1"], ["free", "1"]], "factor": ["2427/1250", "19417/10000"]}
    assert GrowingSequence.from_fields(fields, system) == BOUNCE
    with pytest.raises(ValueError, match="zip"):
        GrowingSequence.from_fields({**fields, "factor": ["2"]}, system)


A, LOST = Assumption("a.kind"), Assumption("lost.so")


def test_growth_in_kept_contact_alone_is_a_statement_of_its_own():
    system = juggling()
    system = replace(system, assumptions=(A,), contact=replace(system.contact, loss=LOST))
    kept = staying("m0")
    period = GrowingSequence((("m0", Fraction(1)),), 4)
    for evidence in (kept, period):
        assert evidence.shown(system) is Shows.INSTABILITY_IN_CONTACT
        assert verdict_of(system, (evidence,)) is Verdict.INCONCLUSIVE
        assert refuted_in(system, (evidence,)) == "in kept contact"
        assert refutes_in_contact(system, (evidence,)) is evidence
        # What it does not cover, it does not take for granted.
        assert granted(system, (evidence,)) == (A,)
        assert evidence.claim(system).endswith("the environment pulling as it pushes.")
        assert common_quadratic_of(system, (evidence,)) is CommonQuadraticStatus.IMPOSSIBLE
    assert refuted_in(system, (kept, BOUNCE)) is refuted_in(system, ()) is None
    assert verdict_of(system, (kept, BOUNCE)) is Verdict.REFUTED
    assert granted(system, (BOUNCE,)) == granted(system, ()) == (A, LOST)
    may = replace(system, contact=replace(system.contact, required=False))
    assert verdict_of(may, (kept,)) is Verdict.REFUTED
    assert granted(replace(system, contact=None), (kept,)) == (A,)


def test_where_free_motion_is_among_the_modes_signs_count_too():
    system = juggling_among_modes()
    kept = staying("m0")
    assert kept.shown(system) is Shows.INSTABILITY_IN_CONTACT
    assert refuted_in(system, (kept,)) == "where contact is lost and made at any deflection"
    assert "at any deflection" in kept.claim(system)
    assert BOUNCE.find_fault(system) is None
    assert "at any deflection" not in BOUNCE.claim(system)
    # A mode that is the same in contact and free needs no sign.
    same = replace(system, flights=Flights((), ("free",)))
    assert kept.shown(same) is Shows.INSTABILITY
    assert kept.claim(same) == kept.claim_in_scope(same)
    assert in_contact((("m0", 1),), NARROW).find_fault(same) is not None
    assert replace(BOUNCE, steps=ONCE[::-1]).find_fault(same) is None


def test_free_motion_that_is_not_stable_refutes():
    system = drifting()
    evidence = staying("free")
    assert evidence.find_fault(system) is None
    assert evidence.shown(system) is Shows.INSTABILITY
    assert "the deflection aside" in evidence.claim(system)
    assert GrowingSequence.from_fields(evidence.to_fields(), system) == evidence
    assert common_quadratic_of(system, (evidence,)) is CommonQuadraticStatus.UNKNOWN
    kept = replace(system, contact=replace(system.contact, required=False))
    assert "do not exist" in evidence.find_fault(kept)
    assert juggling_in_turns().free_motions() == kept.free_motions() == ()
    # At rest in the air, a deflection stays what it is: that is no instability.
    assert "is stable" in staying("free").find_fault(
        replace(bouncing_in_steps(), contact=replace(bouncing_in_steps().contact, required=True))
    )


def test_a_mode_decides_where_contact_is_kept_and_in_the_air():
    for system, mode, expected in (
        (juggling(), "m0", False),
        (replace(juggling(), contact=None), "m0", True),
        (drifting(), "free", True),
    ):
        assert decides(system, mode) is expected


MIDDLE = at(HALF, staying("m0 to m1"))


@pytest.mark.parametrize("time", Time)
@pytest.mark.parametrize(("strength", "grows"), [("1.9", False), (2, True), ("2.1", True)])
def test_known_limit(time, strength, grows):
    """Eigenvalues -1 +- c sqrt(s (1 - s)), in discrete time without the -1: stable iff c < 2."""
    system = hidden_value(strength, time)
    assert (MIDDLE.find_fault(system) is None) is holds(system, MIDDLE) is grows
    # With c = 2 every value but the one in the middle is stable: a matter of exactness.
    beside = at(HALF + Fraction(1, 2**60), MIDDLE)
    assert (beside.find_fault(system) is None) is (strength == "2.1")


def test_shares_are_short():
    system = hidden_value(3)
    for bits, fault in ((63, False), (64, False), (65, True)):
        near = replace(MIDDLE, shares=(HALF + Fraction(1, 2**bits),))
        assert (near.find_fault(system) is not None) is fault


@pytest.mark.parametrize(
    ("share", "holds"), [("-1/9", False), (0, True), ("1/2", True), ("4/7", False), (1, False)]
)
def test_both_ends_are_values_too(share, holds):
    """``x' = (1 - 2 s) x`` is unstable for s up to 1/2."""
    share, part = Fraction(share), staying("m0 to m1")
    system, other_way = (
        family(*ends, switching=PAIR) for ends in ([[[1]], [[-1]]], [[[-1]], [[1]]])
    )
    assert (at(share, part).find_fault(system) is None) is holds
    assert (at(1 - share, part).find_fault(other_way) is None) is holds


def test_a_parameter_that_is_not_declared_constant_has_no_such_value():
    ends = [mode.A.fractions() for mode in hidden_value(3).modes]
    assert "does not cover this kind of switching" in MIDDLE.find_fault(family(*ends))
    assert MIDDLE.find_fault(family(*ends, ends[0], switching=PAIR)) is not None


@pytest.mark.parametrize("time", Time)
def test_a_value_at_which_switching_is_unstable(time):
    kind = "average" if time is Time.CONTINUOUS else "period"
    system, evidence = genuine(f"growing-sequence, {kind} at a value")
    assert evidence.is_average is (time is Time.CONTINUOUS)
    # At the ends switching is stable, and without one value for both it would be no refutation.
    for end in (Fraction(0), Fraction(1)):
        assert replace(evidence, shares=(end,)).find_fault(system) is not None


def test_rules_of_switching_hold_at_a_value_too():
    rows = [mode.A.fractions() for mode in hidden_shears(Time.DISCRETE).modes]
    signal = GrowingSequence((("m0 to m1", Fraction(1)), ("m2 to m3", Fraction(1))), 3)
    evidence = at(HALF, signal)
    there, back = [("m0", "m2"), ("m1", "m3")], [("m2", "m0"), ("m3", "m1")]
    for rules, fault in (
        ({}, False),
        ({"transitions": (*there, *back)}, False),
        ({"transitions": tuple(there)}, True),
        ({"transitions": (*there, back[0])}, True),
        ({"dwell_time": Fraction(2)}, True),
    ):
        system = family(*rows, time=Time.DISCRETE, switching=replace(PAIRS, **rules))
        assert (evidence.find_fault(system) is not None) is fault, rules


def test_resets_are_not_covered_unless_nothing_switches():
    resets = resets_between(("m0", "m2", [[0, 0], [0, 0]]))
    rows = [mode.A.fractions() for mode in hidden_shears(Time.DISCRETE).modes]
    system = family(*rows, time=Time.DISCRETE, switching=replace(PAIRS, resets=resets))
    signal = GrowingSequence((("m0 to m1", Fraction(1)), ("m2 to m3", Fraction(1))), 3)
    assert at(HALF, signal).find_fault(system) is not None
    pair = [mode.A.fractions() for mode in hidden_value(3).modes]
    idle = [[[-1, 0], [0, -1]]] * 2
    alone = family(*pair, *idle, switching=replace(PAIRS, resets=resets))
    assert MIDDLE.find_fault(alone) is None


def test_contact_has_no_value_and_a_sequence_one_witness():
    both = replace(MIDDLE, factor=NARROW)
    assert "the loss of contact" in both.find_fault(hidden_value(3))
    assert "two kinds" in replace(BOUNCE, doublings=3).find_fault(juggling())
    assert "resets" in replace(staying("m0"), edges=(0,)).find_fault(family([[1]]))


def test_claim_names_the_value():
    system = hidden_value(3)
    assert MIDDLE.claim(system).startswith("At 1/2 of the way from the low to the high end")
    parameter = FixedParameter("k", Fraction(10), Fraction("10.5"))
    named = replace(system, switching=replace(PAIR, fixed_parameters=(parameter,)))
    assert MIDDLE.claim(named).startswith("At k = 10.25, which the range allows and which does not")
    assert "Mode m0 to m1 is not Hurwitz" in MIDDLE.claim(named)


def enclosing(*factors, names=("m0", "m1")):
    """Modes of one state, of which only combinations need be attained."""
    system = family(*([[factor]] for factor in factors), time=Time.DISCRETE)
    return replace(system, enclosures=(names,))


@pytest.mark.parametrize(
    ("factors", "grows"),
    [
        (("1.1", "1.2"), True),
        (("1.1", "0.5"), False),
        # From -1.1 to 1.1 there is zero, although each end grows.
        (("1.1", "-1.1"), False),
        # No trace of a power says that a radius of exactly one does not decay.
        (("1", "1.1"), False),
    ],
)
@pytest.mark.parametrize("doublings", [None, 3])
def test_corners_of_an_enclosure_grow_all_or_refute_nothing(factors, grows, doublings):
    system = enclosing(*factors)
    evidence = replace(staying("m0"), doublings=doublings)
    assert (evidence.find_fault(system) is None) is grows
    attained = replace(system, enclosures=())
    assert evidence.find_fault(attained) is None or factors[0] == "1"


def test_the_other_corner_of_an_enclosure_is_as_good():
    """A set stands for what is attained, so each mode of it does."""
    system = enclosing("1.1", "1.2")
    assert staying("m1").find_fault(system) is None
    assert "No corner of an enclosure need be attained" in staying("m1").claim(system)


def test_a_sequence_goes_through_all_that_is_enclosed():
    """Of 3/2 and 1/2..5/6 in turn, only the larger one grows; of 3/2 and 5/6, both do."""
    signal = GrowingSequence((("m0", Fraction(1)), ("m1", Fraction(1))), 4)
    for low, grows in (("0.5", False), ("0.8", True)):
        system = family([["3/2"]], [["5/6"]], [[low]], time=Time.DISCRETE)
        system = replace(system, enclosures=(("m1", "m2"),))
        assert (signal.find_fault(system) is None) is grows


def test_growth_that_keeps_the_signs_is_that_of_all_that_is_enclosed():
    system, evidence = genuine("growing-sequence, contact")
    assert evidence.factor is not None
    assert evidence.find_fault(system) is None
    name = evidence.steps[0][0]
    mode = next(mode for mode in system.every_mode if mode.name == name)
    still = Mode("still", matrix([[v / 2 for v in row] for row in mode.A.fractions()]))
    system = replace(system, modes=(*system.modes, still), enclosures=((name, "still"),))
    assert "does not show a growing motion" in evidence.find_fault(system)


def test_in_continuous_time_a_corner_of_an_enclosure_refutes_nothing():
    system = replace(family([["1"]], [["2"]]), enclosures=(("m0", "m1"),))
    assert "is a corner of an enclosure" in staying("m0").find_fault(system)
    average = GrowingSequence((("m0", Fraction(1, 2)), ("m1", Fraction(1, 2))))
    assert "is a corner of an enclosure" in average.find_fault(system)


@pytest.mark.parametrize(
    ("sets", "share", "grows"),
    [
        # Halfway it is from 1.1 to 1.2, at the low end from 0.9 on.
        ((("m0", "m1"), ("m2", "m3")), Fraction(1, 2), True),
        ((("m0", "m1"), ("m2", "m3")), Fraction(0), False),
        # Which weights belong together is not known.
        ((("m0", "m1"), ("m3", "m2")), Fraction(1, 2), False),
        ((("m0", "m1", "m2"),), Fraction(1, 2), False),
        ((("m0", "m1"),), Fraction(1, 2), False),
    ],
)
def test_at_a_value_of_a_constant_enclosures_are_between_its_corners(sets, share, grows):
    system = family([["0.9"]], [["1"]], [["1.3"]], [["1.4"]], time=Time.DISCRETE)
    ends = Switching(fixed_ends=(("m0", "m2"), ("m1", "m3")))
    system = replace(system, switching=ends, enclosures=sets)
    evidence = replace(staying("m0 to m2"), shares=(share,))
    assert (evidence.find_fault(system) is None) is grows


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"steps": []}, "there are no steps"),
        ({"steps": [["m0", "1"]], "edges": [0, 0]}, "one edge for each"),
        ({"steps": [["m0", "1"]], "shares": ["1/2"]}, "no parameter is constant"),
        ({"steps": [["m0", "1"]], "shares": [f"1/{2**64 + 1}"]}, "a share has too many digits"),
    ],
)
def test_what_cannot_be_put_into_words_is_not_read(fields, reason):
    with pytest.raises(ValueError, match=reason):
        GrowingSequence.from_fields(fields, UNSTABLE)
