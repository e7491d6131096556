"""Evidence of kind unstable-period: published limits, which signals are admissible, attacks."""

from dataclasses import replace
from fractions import Fraction
from math import log

import numpy as np
import pytest
from flint import arb, ctx, fmpq

from nrs_design.proof.enclosure import precision
from nrs_design.proof.evidence import UnstablePeriod, read_evidence
from nrs_design.proof.evidence.unstable_period import monodromy
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.certify import Verdict, certify
from nrs_design.search.method import Method
from tests.proof.systems import (
    branicky,
    dayawansa_martin,
    family,
    genuine,
    geromel_colaneri,
    golden,
    matrix,
    must_leave,
    oscillator,
    resets_between,
    robot,
    two_ways,
)
from tests.proof.truth import exponential, holds
from tests.support import ends_soon

WIDE = [("1", "2.15"), ("200", "2.15")]


def signal(*steps, doublings=20):
    named = tuple((f"m{mode}", Fraction(dwell)) for mode, dwell in steps)
    return UnstablePeriod(named, doublings)


def by_period(system):
    return certify(system, Method.PERIOD)


@pytest.mark.parametrize("a", ["11.262", "11.27", "12", "30"])
def test_pair_of_dayawansa_and_martin_is_refuted_beyond_its_limit(a):
    found = by_period(dayawansa_martin(a))
    assert found.verdict is Verdict.REFUTED
    assert holds(found.system, found.evidence)


@pytest.mark.parametrize("a", ["11.2", "11.26", "6"])
def test_and_never_below_it(a):
    # The limit is 11.2608....
    assert by_period(dayawansa_martin(a)).verdict is not Verdict.REFUTED


@pytest.mark.parametrize(("kbar", "refuted"), [("6.98", False), ("6.99", True), ("7", True)])
def test_oscillator_on_both_sides_of_its_limit(kbar, refuted):
    # 6.98513.
    assert (by_period(oscillator(kbar)).verdict is Verdict.REFUTED) is refuted


@pytest.mark.parametrize(
    ("dwell", "refuted"),
    [("2.70", True), ("2.707", True), ("2.7078", False), ("2.76", False), ("3", False)],
)
def test_pair_of_geromel_and_colaneri_by_dwell_time(dwell, refuted):
    # Unstable up to 2.70775 s.
    found = by_period(geromel_colaneri(dwell))
    assert (found.verdict is Verdict.REFUTED) is refuted
    if refuted:
        assert all(time >= Fraction(dwell) for _, time in found.evidence.steps)


@pytest.mark.parametrize(("c", "refuted"), [("0.618", False), ("0.6181", True)])
def test_golden_ratio(c, refuted):
    # 1/0.61803... is the joint spectral radius of the pair, reached by alternating.
    found = by_period(golden(c))
    assert (found.verdict is Verdict.REFUTED) is refuted
    if refuted:
        assert {name for name, _ in found.evidence.steps} == {"m0", "m1"}


def test_wide_range_of_stiffness_without_virtual_mass():
    # Both modes are Hurwitz; 0.04597 s and 0.03276 s in turn grow by about 1 1/s.
    system = robot("0", WIDE)
    steps = ((1, "0.04597"), (0, "0.03276"))
    evidence = [signal(*order) for order in (steps, [(1 - m, t) for m, t in steps])]
    growing = [item for item in evidence if item.find_fault(system) is None]
    assert growing
    flows = [
        exponential(np.array(system.modes[int(name[1])].A.floats()) * float(dwell))
        for name, dwell in growing[0].steps
    ]
    radius = np.abs(np.linalg.eigvals(flows[1] @ flows[0])).max()
    assert log(radius) / (0.04597 + 0.03276) == pytest.approx(1.0, abs=0.1)
    assert by_period(system).verdict is Verdict.REFUTED


def test_a_spectral_radius_of_exactly_one_is_no_growth():
    rotation = family([[0, 1], [-1, 0]])
    quarter = family([[0, 1], [-1, 0]], time=Time.DISCRETE)
    for doublings in range(0, 61, 6):
        assert signal((0, "1.5"), doublings=doublings).find_fault(rotation) is not None
        assert signal((0, 1), doublings=doublings).find_fault(quarter) is not None
    jordan = family([[1, 1], [0, 1]], time=Time.DISCRETE)
    assert signal((0, 1), doublings=60).find_fault(jordan) is not None


def test_a_radius_barely_above_one_needs_many_doublings():
    barely = family([["1.0000001", 0], [0, "1/2"]], time=Time.DISCRETE)
    assert signal((0, 1), doublings=2).find_fault(barely) is not None
    assert signal((0, 1), doublings=30).find_fault(barely) is None
    below = family([["0.9999999", 0], [0, "1/2"]], time=Time.DISCRETE)
    assert all(signal((0, 1), doublings=k).find_fault(below) for k in range(61))


def test_a_large_transient_is_no_growth():
    shear = family([["1/2", 10**12], [0, "1/2"]], time=Time.DISCRETE)
    assert all(signal((0, 1), doublings=k).find_fault(shear) for k in range(0, 61, 3))


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


def test_resets_at_the_switch_back_to_the_first_mode_count():
    pair = [[-1, 0], [0, -1]], [[-1, 0], [0, -1]]
    grow = resets_between(("m1", "m0", [[9, 0], [0, 9]]))
    evidence = signal((0, "0.5"), (1, "0.5"))
    assert evidence.find_fault(family(*pair, switching=Switching(resets=grow))) is None
    assert evidence.find_fault(family(*pair)) is not None
    elsewhere = resets_between(("m0", "m0", [[9, 0], [0, 9]]))
    staying = family(*pair, switching=Switching(resets=elsewhere))
    assert evidence.find_fault(staying) is not None
    # Two steps of one mode are a longer stay, and no switch.
    assert signal((0, "0.5"), (0, "0.5")).find_fault(staying) is not None


def test_dwell_times_transitions_and_constant_parameters_are_obeyed():
    system, evidence = genuine("unstable-period")
    longest = max(dwell for _, dwell in evidence.steps)
    for switching in (
        Switching(longest),
        Switching(transitions=(("m0", "m1"),)),
        Switching(transitions=(("m1", "m0"),)),
        Switching(transitions=()),
        Switching(fixed_ends=(("m0", "m1"),)),
    ):
        assert evidence.find_fault(replace(system, switching=switching)) is not None
    shortest = min(dwell for _, dwell in evidence.steps)
    for switching in (
        Switching(shortest),
        Switching(transitions=(("m0", "m1"), ("m1", "m0"))),
    ):
        assert evidence.find_fault(replace(system, switching=switching)) is None


def test_one_value_of_a_constant_parameter_refutes():
    rows = [mode.A.fractions() for mode in branicky().modes]
    system = family(
        rows[0], rows[1], rows[0], rows[1], switching=Switching(
            fixed_ends=(("m0", "m2"), ("m1", "m3"))
        )
    )  # fmt: skip
    _, evidence = genuine("unstable-period")
    assert evidence.find_fault(system) is None
    crossed = replace(evidence, steps=tuple(
        ({"m1": "m3"}.get(name, name), dwell) for name, dwell in evidence.steps
    ))  # fmt: skip
    assert crossed.find_fault(system) is not None


def test_steps_are_whole_in_discrete_time():
    assert signal((0, "1.5"), (1, 1)).find_fault(golden("0.7")) is not None
    assert signal((0, 1), (1, 1)).find_fault(golden("0.7")) is None


@pytest.mark.parametrize(
    "evidence",
    [
        signal(),
        signal((0, 0), (1, 1)),
        signal((0, -1), (1, 1)),
        signal((0, 4097)),
        signal((7, 1)),
        signal((0, 1), (1, 1), doublings=-1),
        signal((0, 1), (1, 1), doublings=61),
        signal((0, 1), (1, 1), doublings=10**30),
        UnstablePeriod((("m0", Fraction(1)),) * 10**6, 3),
    ],
)
@pytest.mark.parametrize("time", list(Time))
def test_signals_out_of_range_are_rejected_at_once(evidence, time):
    system = replace(family([[5, 1], [0, 5]], [[5, 0], [1, 5]]), time=time)
    with ends_soon():
        assert evidence.find_fault(system) is not None


@pytest.mark.parametrize("time", list(Time))
def test_long_signals_of_many_states_do_not_hang(time):
    n = 64
    A = [[(i * 7 + j * 3) % 5 - 2 - 9 * (i == j) for j in range(n)] for i in range(n)]
    system = family(A, time=time)
    with ends_soon():
        assert signal(*[(0, 4000 - k) for k in range(500)]).find_fault(system) is not None


def test_enormous_modes_do_not_hang_or_overflow():
    for time in Time:
        system = family([[-(10**200), 10**200], [-(10**200), -1]], time=time)
        with ends_soon():
            signal((0, 4096), doublings=60).find_fault(system)


def test_the_precision_of_flint_is_left_as_it_was():
    before = ctx.prec
    genuine("unstable-period")
    system, evidence = genuine("unstable-period")
    evidence.find_fault(system)
    assert ctx.prec == before
    with pytest.raises((ValueError, ZeroDivisionError)):
        UnstablePeriod((("m0", Fraction(1)),), 3).find_fault(family([[1]])) or read_evidence(
            {"kind": "unstable-period", "steps": [["m0", "1/0"]]}, system
        )
    assert ctx.prec == before


def test_exponentials_enclose_those_of_numpy():
    A = matrix([["-0.3", 7], [-5, "-0.1"]])
    system = family(A.fractions())
    before, ctx.prec = ctx.prec, 300
    try:
        enclosed = monodromy(system, (("m0", Fraction(5, 4)),))
    finally:
        ctx.prec = before
    found = np.array([[float(enclosed[i, j].mid()) for j in range(2)] for i in range(2)])
    assert found == pytest.approx(exponential(np.array(A.floats()) * 1.25), rel=1e-9)


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


def test_dwell_times_by_mode():
    stays = (("m1", Stay(Fraction(2))),)
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    system = family(*pair, time=Time.DISCRETE, switching=Switching(stays=stays))
    assert signal((0, 1), (1, 2)).find_fault(system) is None
    assert "does not cover" in signal((0, 1), (1, 1)).find_fault(system)
    assert signal((0, 1), (1, 1)).find_fault(family(*pair, time=Time.DISCRETE)) is None


def test_which_reset_is_taken_must_be_said():
    steps = signal((0, 1), (1, 1)).steps
    system = two_ways(5)
    assert UnstablePeriod(steps, 6, (1, 0)).find_fault(system) is None
    # The other reset, none of them, one too many, one that does not exist.
    wrong = [(0, 0), (), (1,), (1, 0, 0), (2, 0), (-1, 0), (1, 1)]
    for edges in wrong:
        evidence = UnstablePeriod(steps, 6, edges)
        assert evidence.find_fault(system) is not None
        assert len(edges) != 2 or not holds(system, evidence)
    assert UnstablePeriod(steps, 6, (1, 0)).find_fault(two_ways("3.9")) is not None


def test_the_reset_that_is_taken_is_in_the_file():
    system, evidence = genuine("unstable-period, two ways")
    fields = {"kind": evidence.kind, **evidence.to_fields()}
    assert fields["edges"] == [1, 0]
    assert "then reset 2 to m1, m1 for 1 steps)" in evidence.claim(system)
    assert read_evidence(fields, system) == evidence
    with pytest.raises(ValueError, match="one edge for each step"):
        read_evidence({**fields, "edges": [1]}, system)
    assert "edges" not in genuine("unstable-period")[1].to_fields()


def test_an_edge_against_the_transitions_refutes_nothing():
    one_way = must_leave(4, transitions=(("m1", "m0"),))
    assert "does not cover" in signal((0, 4), (1, 1)).find_fault(one_way)


def test_a_signal_that_is_too_long_is_not_looked_at():
    steps = (("m0", Fraction(1)), ("m1", Fraction(1))) * 513
    assert "does not cover" in UnstablePeriod(steps, 3).find_fault(branicky())


GROWING = [[1, 1], [0, 1]], [[1, 0], [1, 1]]
STEPS, SECONDS = Time.DISCRETE, Time.CONTINUOUS


def test_the_longest_signal():
    system = family(*GROWING, time=STEPS)
    longest = signal(*[(0, 1), (1, 1)] * 512, doublings=0)
    assert longest.find_fault(system) is None
    longer = replace(longest, steps=(*longest.steps, ("m0", Fraction(1))))
    assert longer.find_misfit(system) == "the signal is empty or too long"
    assert "does not cover" in longer.find_fault(system)
    assert signal().find_misfit(system) == "the signal is empty or too long"


@pytest.mark.parametrize(("doublings", "fits"), [(-1, False), (0, True), (60, True), (61, False)])
def test_doublings(doublings, fits):
    evidence = signal((0, 1), (1, 1), doublings=doublings)
    fault = None if fits else "the signal is empty or too long"
    assert evidence.find_fault(family(*GROWING, time=STEPS)) == fault


def test_the_most_work(monkeypatch):
    limit = "nrs_design.proof.evidence.unstable_period.MAX_WORK"
    evidence, system = signal((0, 1), (1, 1), doublings=2), family(*GROWING, time=STEPS)
    monkeypatch.setattr(limit, 2 * 2**3)
    assert evidence.find_fault(system) is None
    monkeypatch.setattr(limit, 2 * 2**3 - 1)
    assert evidence.find_fault(system) == "the signal is too long for so many states"


@pytest.mark.parametrize(
    ("count", "fault"),
    [
        (5, "the signal uses modes that do not exist"),
        (6, "the signal is too long for so many states"),
    ],
)
def test_the_most_steps_of_a_hundred_states(count, fault):
    system = family([[int(i == j) for j in range(100)] for i in range(100)], time=STEPS)
    assert signal(*[(9, 1)] * count).find_misfit(system) == fault


@pytest.mark.parametrize(
    ("dwell", "time", "fault"),
    [
        ("4096", SECONDS, None),
        ("4096", STEPS, None),
        ("4097", STEPS, "a dwell time is not between 0 and 4096"),
        ("8193/2", SECONDS, "a dwell time is not between 0 and 4096"),
        ("0", SECONDS, "a dwell time is not between 0 and 4096"),
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
        assert UnstablePeriod(steps, 3, edges).fits(system.switching) is fits
    one = Switching(resets=resets[:1])
    assert UnstablePeriod(steps, 3).fits(one)
    assert UnstablePeriod(steps, 3).fits(Switching())


@pytest.mark.parametrize(
    ("growth", "doublings", "expands"),
    [("3", 0, True), ("2", 0, False), ("-3", 0, True), ("7/4", 0, False), ("7/4", 1, True)],
)
def test_a_trace_beyond_the_number_of_states(growth, doublings, expands):
    """Of diag(g, 0): g to the power 2^k is compared to two."""
    system = family([[growth, 0], [0, 0]], time=STEPS)
    fault = None if expands else "the enclosure of the monodromy matrix does not show growth"
    assert signal((0, 1), doublings=doublings).find_fault(system) == fault


def test_claims():
    ways = two_ways(5)
    resets = UnstablePeriod((("m0", Fraction(1)), ("m1", Fraction(2))), 6, (1, 0)).claim(ways)
    assert resets == (
        "Repeating the signal (m0 for 1 steps, then reset 2 to m1, m1 for 2 steps) makes some "
        "solution grow without bound: the spectral radius over one period is above 1, so "
        "x+ = A x is unstable under this switching."
    )
    first = UnstablePeriod((("m0", Fraction(1)), ("m1", Fraction(2))), 6).claim(ways)
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


def test_edges_in_a_file():
    system, evidence = genuine("unstable-period")
    fields = {"kind": evidence.kind, **evidence.to_fields()}
    assert read_evidence(fields, system).edges == ()
    edges = [0] * len(evidence.steps)
    assert read_evidence({**fields, "edges": edges}, system).edges == tuple(edges)
    for wrong in ([0], [*edges, 0]):
        with pytest.raises(ValueError, match="one edge for each step"):
            read_evidence({**fields, "edges": wrong}, system)
