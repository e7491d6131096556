"""Evidence of kind mode-quadratic: dwell times, transition graphs, resets, unequal modes."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import pytest

from nrs_design.proof.evidence import ModeQuadratic, read_evidence
from nrs_design.proof.evidence.mode_quadratic import find_odd_switch, signals_of
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Reset, Stay, Switching
from nrs_design.search.certify import Verdict, certify
from nrs_design.search.method import Method
from tests.proof.systems import (
    ando_shih,
    dayawansa_martin,
    family,
    genuine,
    geromel_colaneri,
    golden,
    must_leave,
    must_leave_in_time,
    rectangular,
    resets_between,
    shears,
    slow_switching_in_steps,
    two_ways,
)
from tests.proof.truth import holds
from tests.support import ends_soon

I2 = ((1, 0), (0, 1))


def by_modes(system):
    return certify(system, Method.MODE_QUADRATIC)


def functions(*forms, rate="1/100"):
    named = tuple((f"m{i}", Q) for i, Q in enumerate(forms))
    return ModeQuadratic(named, 0, Fraction(rate))


@pytest.mark.parametrize("dwell", ["2.752", "2.76", "3", "20"])
def test_pair_of_geromel_and_colaneri_above_the_published_dwell_time(dwell):
    found = by_modes(geromel_colaneri(dwell))
    assert found.verdict is Verdict.PROVED
    # Eigenvalues of the slower mode: -0.25 +- 0.19j.
    assert 0 < found.evidence.rate <= Fraction(1, 4)
    assert holds(found.system, found.evidence)


@pytest.mark.parametrize("dwell", ["0", "1", "2.70", "2.707", "2.75"])
def test_and_never_below_it(dwell):
    # The conditions are feasible from 2.75084 s on.
    assert by_modes(geromel_colaneri(dwell)).verdict is not Verdict.PROVED


def test_evidence_for_one_dwell_time_is_none_for_a_shorter_one():
    _, evidence = genuine("mode-quadratic, dwell")
    assert evidence.find_fault(geromel_colaneri("2.76")) is None
    for dwell in ("2.75", "2", "0"):
        assert evidence.find_fault(geromel_colaneri(dwell)) is not None


@pytest.mark.parametrize(("c", "proved"), [("0.707", True), ("0.99", True), ("1", False)])
def test_ando_and_shih_up_to_their_joint_spectral_radius(c, proved):
    assert (by_modes(ando_shih(c)).verdict is Verdict.PROVED) is proved


@pytest.mark.parametrize(("c", "proved"), [("0.617", True), ("0.6181", False)])
def test_golden_ratio(c, proved):
    found = by_modes(golden(c))
    assert (found.verdict is Verdict.PROVED) is proved
    if proved:
        assert 0.617 * (1 + 5**0.5) / 2 <= float(found.evidence.rate) < 1


def test_one_way_needs_nothing_in_common_and_both_ways_everything():
    one_way = dayawansa_martin(12, Switching(transitions=(("m0", "m1"),)))
    _, evidence = genuine("mode-quadratic, one way")
    assert evidence.find_fault(one_way) is None
    back = replace(one_way, switching=Switching(transitions=(("m1", "m0"),)))
    both = replace(one_way, switching=Switching())
    assert evidence.find_fault(back) is not None
    assert "raises" in str(evidence.find_fault(both))


def test_no_switch_at_all_needs_each_mode_alone():
    never = Switching(transitions=())
    assert by_modes(shears(never)).verdict is Verdict.PROVED


@pytest.mark.parametrize(
    "rules",
    [
        Switching(Fraction(50), fixed_ends=(("m0", "m1"),)),
        Switching(transitions=(), fixed_ends=(("m0", "m1"),)),
        Switching(fixed_ends=(("m0", "m1"),)),
    ],
)
def test_the_ends_of_a_constant_parameter_prove_nothing_in_between(rules):
    # Both ends are Hurwitz; halfway, [[-1, 5], [5, -1]] has the eigenvalue 4.
    system = shears(rules)
    found = by_modes(replace(system, switching=replace(rules, fixed_ends=())))
    if found.evidence is not None:
        assert found.evidence.find_fault(system) is not None
    assert by_modes(system).verdict is not Verdict.PROVED


def test_a_reset_may_be_as_large_as_the_dwell_time_makes_up_for():
    # x' = -x for one second: factors up to e = 2.718... are made up for.
    for factor, fault in (("2.7", False), ("2.72", True)):
        resets = resets_between(("m0", "m1", [[factor]]), ("m1", "m0", [[factor]]))
        system = family([[-1]], [[-1]], switching=Switching(Fraction(1), resets=resets))
        evidence = functions(((1,),), ((1,),), rate="1/10000")
        assert (evidence.find_fault(system) is not None) is fault


def test_equality_is_allowed_at_a_switch_without_dwell_time_and_nothing_above():
    for factor, fault in (("1", False), ("-1", False), ("1.0000001", True)):
        resets = resets_between(("m0", "m1", [[factor, 0], [0, "1/2"]]))
        switching = Switching(transitions=(("m0", "m1"),), resets=resets)
        system = family([[-1, 0], [0, -1]], [[-1, 0], [0, -1]], switching=switching)
        assert (functions(I2, I2).find_fault(system) is not None) is fault


@pytest.mark.parametrize(
    "resets",
    [
        # Which of the two would be in force?
        [("m0", "m1", [["1/2"]]), ("m0", "m1", [[99]])],
        # A jump within a mode is no switch: nothing would check it.
        [("m0", "m0", [[99]])],
    ],
)
def test_ambiguous_resets_are_not_covered(resets):
    switching = Switching(resets=resets_between(*resets))
    evidence = functions(((1,),), ((1,),))
    assert evidence.find_fault(family([[-1]], [[-1]], switching=switching)) is not None


def test_modes_of_unequal_size():
    system, evidence = genuine("mode-quadratic, rectangular")
    assert [len(Q) for _, Q in evidence.functions] == [2, 1]
    assert holds(system, evidence)
    swapped = replace(evidence, functions=evidence.functions[::-1])
    assert swapped.find_fault(system) is not None


def test_unequal_modes_need_a_reset_of_the_right_shape():
    system = rectangular()
    _, evidence = genuine("mode-quadratic, rectangular")
    for resets in ((), system.switching.resets[:1], system.switching.resets[::-1][:1]):
        broken = replace(system, switching=Switching(resets=resets))
        assert "no fitting reset" in str(evidence.find_fault(broken))
    turned = resets_between(("m0", "m1", [["1/2"], [0]]), ("m1", "m0", [["1/2", 0]]))
    assert evidence.find_fault(replace(system, switching=Switching(resets=turned))) is not None


def test_steps_of_discrete_time_are_counted_as_stays():
    # One step in turn has the monodromy [[1/2, 2], [0, 1/2]] [[1/2, 0], [2, 1/2]]: it grows.
    system, evidence = genuine("mode-quadratic, steps")
    assert evidence.find_fault(system) is None
    for steps in (1, 2):
        shorter = replace(system, switching=Switching(Fraction(steps)))
        assert evidence.find_fault(shorter) is not None
    longer = replace(system, switching=Switching(Fraction(7)))
    assert by_modes(longer).verdict is Verdict.PROVED


def test_a_dwell_time_of_zero_in_discrete_time_is_one_step():
    system = ando_shih("0.99")
    _, evidence = genuine("mode-quadratic, discrete")
    assert evidence.find_fault(replace(system, switching=Switching(Fraction(1)))) is None
    assert "whole" in str(evidence.find_fault(replace(system, switching=Switching(Fraction(3, 2)))))


def test_modes_with_one_name_are_rejected():
    system = family([[-1]], [[5]], names=["m0", "m0"])
    evidence = ModeQuadratic((("m0", ((1,),)), ("m0", ((1,),))), 0, Fraction(1, 2))
    assert "same name" in str(evidence.find_fault(system))


@pytest.mark.parametrize("Q", [((1, 1), (0, 1)), ((1, 0),), ((1,), (0,)), ()])
def test_a_form_that_is_not_symmetric_is_a_fault_and_not_a_crash(Q):
    for switching in (Switching(), Switching(Fraction(3))):
        assert functions(Q, I2).find_fault(shears(switching)) is not None


@pytest.mark.parametrize("exponent", [3, 9, 12, 30, 100, 300])
def test_stiff_modes_neither_hang_nor_crash(exponent):
    # Over one second, exp(-10^9) has more than 10^9 bits: far below what is ever written down.
    fast = 10**exponent
    system = family([[-fast, 0], [0, -1]], [[-1, 0], [0, -fast]], switching=Switching(Fraction(1)))
    with ends_soon():
        assert functions(I2, I2).find_fault(system) is None
        coupled = family(
            [[-fast, fast], [-fast, -1]],
            [[-1, 1], [-1, -fast]],
            switching=Switching(Fraction(4096)),
        )
        functions(I2, I2).find_fault(coupled)


def test_hostile_dwell_times_rates_and_sizes_do_not_hang():
    n = 64
    A = [[(i * j) % 5 - 2 - 900 * (i == j) for j in range(n)] for i in range(n)]
    Q = tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
    slow = [[Fraction(entry, 1000) for entry in row] for row in A]
    with ends_soon():
        for dwell in (4096, 4097, 10**30):
            system = family(slow, slow, time=Time.DISCRETE, switching=Switching(Fraction(dwell)))
            assert functions(Q, Q, rate="999/1000").find_fault(system) is not None
            small = family([["1/2"]], [["1/3"]], time=Time.DISCRETE, switching=system.switching)
            long_rate = str(Fraction(10**1999 - 1, 10**1999))
            assert functions(((1,),), ((1,),), rate=long_rate).find_fault(small) is not None


def test_four_thousand_steps_of_a_small_system_are_checked():
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    system = family(*pair, time=Time.DISCRETE, switching=Switching(Fraction(4096)))
    evidence = functions(((1, 0), (0, 100)), ((100, 0), (0, 1)), rate="99/100")
    with ends_soon():
        assert evidence.find_fault(system) is None


def test_slow_switching_in_steps_is_really_needed():
    fast = replace(slow_switching_in_steps(), switching=Switching())
    assert certify(fast).verdict is Verdict.REFUTED


def scalars(*values, **fields):
    named = tuple((f"m{i}", ((value,),)) for i, value in enumerate(values))
    return ModeQuadratic(named, 0, **fields)


@pytest.mark.parametrize("longest", [1, 2, 3, 4])
def test_every_stay_in_a_mode_that_must_be_left(longest):
    # After k steps in m0, 4^k 30 < 960; after one in m1, 960/64 < 30.
    evidence = scalars(960, 30, rate=Fraction(999, 1000), leaving=("m0",))
    system = must_leave(longest)
    assert (evidence.find_fault(system) is None) is (longest <= 2)
    assert holds(system, evidence) is (longest <= 2)


def test_a_mode_that_may_stay_must_decrease():
    evidence = scalars(960, 30, rate=Fraction(999, 1000), leaving=("m0",))
    forever = must_leave(2, dwell_time=Fraction(1))
    forever = replace(forever, switching=replace(forever.switching, stays=()))
    assert "has no longest dwell time" in evidence.find_fault(forever)
    assert "does not decrease" in replace(evidence, leaving=()).find_fault(must_leave(2))
    assert evidence.find_fault(must_leave(2)) is None


@pytest.mark.parametrize("leaving", [("m0", "m0"), ("m2",), ("m0", "m1"), ("m1",)])
def test_modes_that_must_be_left_are_checked(leaving):
    evidence = scalars(960, 30, rate=Fraction(999, 1000), leaving=leaving)
    assert evidence.find_fault(must_leave(2)) is not None


@pytest.mark.parametrize("pieces", [0, -1, 4097])
def test_pieces_are_limited(pieces):
    system, evidence = genuine("mode-quadratic, left in time")
    assert "pieces" in replace(evidence, pieces=pieces).find_fault(system)


@pytest.mark.parametrize(("rest", "stable"), [("1.2", True), ("1.01", True), ("0.99", False)])
def test_all_times_in_a_mode_that_must_be_left(rest, stable):
    # exp(2 t) Q1 < Q0 up to t = 1, and exp(-2 rest) Q0 < Q1.
    evidence = scalars(750, 100, rate=Fraction(1, 1000), leaving=("m0",), pieces=1024)
    system = must_leave_in_time(rest)
    assert (evidence.find_fault(system) is None) is stable
    assert holds(system, evidence) is stable


def test_the_end_of_a_stay_counts():
    # 738 is less than 100 exp(2): too small by a little at the last time in m0.
    late = scalars(738, 100, rate=Fraction(1, 1000), leaving=("m0",), pieces=4096)
    assert late.find_fault(must_leave_in_time("1.2")) is not None


def test_the_middle_of_a_stay_counts():
    """A turn that is harmless at both ends of a stay, and not in between."""
    turn = [[0, "3.14159265"], ["-3.14159265", 0]]
    stays = (("m0", Stay(Fraction(1), Fraction(2))), ("m1", Stay(Fraction(1))))
    system = family(turn, [[-1, 0], [0, -1]], switching=Switching(stays=stays))
    Q = (("m0", ((100, 0), (0, 4))), ("m1", ((60, 0), (0, 2))))
    evidence = ModeQuadratic(Q, 0, Fraction(1, 1000), ("m0",), 256)
    assert not holds(system, evidence)
    assert "after some stay" in evidence.find_fault(system)
    large = replace(evidence, functions=(("m0", ((100, 0), (0, 90))), ("m1", ((60, 0), (0, 59)))))
    assert large.find_fault(system) is None
    assert holds(system, large)
    # Pieces that are too coarse show nothing.
    assert "after some stay" in replace(large, pieces=1).find_fault(system)
    ends = [replace(system, switching=Switching(stays=(("m0", Stay(*[Fraction(t)] * 2)), stays[1])))
            for t in (1, 2)]  # fmt: skip
    assert [evidence.find_fault(end) for end in ends] == [None, None]


def test_the_weakest_of_several_resets_counts():
    system, evidence = genuine("mode-quadratic, two ways")
    assert holds(system, evidence)
    assert "raises the function" in evidence.find_fault(two_ways(5))
    assert not holds(two_ways(5), evidence)


def test_files_name_the_modes_that_must_be_left():
    for example in ("mode-quadratic, left", "mode-quadratic, left in time"):
        system, evidence = genuine(example)
        fields = {"kind": evidence.kind, **evidence.to_fields()}
        assert fields["leaving"] == ["m0"]
        assert read_evidence(fields, system) == evidence
        for key in ("leaving", "pieces"):
            short = {k: v for k, v in fields.items() if k != key}
            assert read_evidence(short, system).find_fault(system) is not None or key == "pieces"
    assert not genuine("mode-quadratic, dwell")[1].to_fields().keys() & {"leaving", "pieces"}


def test_contradictory_rules():
    evidence = scalars(960, 30, rate=Fraction(999, 1000), leaving=("m0",))
    for stays in (
        (("m0", Stay(Fraction(3), Fraction(2))),),
        (("m0", Stay(Fraction(0), Fraction(1, 2))),),
        (("m0", Stay(Fraction(1), Fraction(2))), ("m0", Stay(Fraction(1), Fraction(1)))),
        (("m2", Stay(Fraction(1), Fraction(2))),),
    ):
        system = replace(must_leave(2), switching=Switching(stays=stays))
        assert evidence.find_fault(system) is not None


def test_a_switch_with_numbers_that_would_take_minutes_is_refused():
    n = 20
    A = [[-int(i == j) for j in range(n)] for i in range(n)]
    tiny = RationalMatrix(tuple(tuple(int(i == j) for j in range(n)) for i in range(n)), 2**7000)
    system = family(A, A, switching=Switching(resets=(Reset("m0", "m1", tiny),)))
    identity = tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
    fault = functions(identity, identity, rate="1/2").find_fault(system)
    assert fault == "the numbers at the switch from m0 are too large to check"


def test_more_switches_than_can_be_checked_are_refused():
    modes = tuple(Mode(f"m{i}", RationalMatrix(((-1,),))) for i in range(1200))
    system = replace(family([[-1]]), modes=modes)
    with ends_soon():
        assert "too many switches" in functions(*[((1,),)] * 1200, rate="1/2").find_fault(system)


def test_many_dwell_times_are_counted_and_not_listed():
    stays = tuple((f"m{i}", Stay(Fraction(1), None)) for i in range(9))
    system = family(*[[[-1]]] * 9, switching=Switching(stays=stays))
    claim = functions(*[((1,),)] * 9, rate="1/2").claim(system)
    assert "9 modes with dwell times of their own" in claim


MODULE = "nrs_design.proof.evidence.mode_quadratic"
HALF, IN_STEPS = Fraction(1, 2), {"time": Time.DISCRETE}


def left_within(*stays, **rules):
    """Rules by which m0, m1, ... are left, each from a shortest to a longest time."""
    named = tuple(
        (f"m{k}", Stay(*(end if end is None else Fraction(end) for end in stay)))
        for k, stay in enumerate(stays)
    )
    return Switching(stays=named, **rules)


@pytest.mark.parametrize(
    ("dwell", "time", "fault"),
    [
        (4096, Time.CONTINUOUS, None),
        (Fraction(8193, 2), Time.CONTINUOUS, "the dwell time is too long"),
        (4096, Time.DISCRETE, None),
        (4097, Time.DISCRETE, "the dwell time is too long"),
        (Fraction(3, 2), Time.DISCRETE, "the dwell time is not a whole number of steps"),
        (Fraction(3, 2), Time.CONTINUOUS, None),
    ],
)
def test_dwell_times_within_the_limits(dwell, time, fault):
    system, evidence = family([["-1/2"]], [["-1/2"]], time=time), scalars(1, 1, rate=HALF)
    at_once = replace(system, switching=Switching(Fraction(dwell)))
    assert evidence.find_misfit(at_once) == fault
    for stays in ((1, dwell), (dwell, dwell)), ((dwell, dwell), (1, dwell)):
        left = replace(system, switching=left_within(*stays))
        assert replace(evidence, leaving=("m0", "m1")).find_misfit(left) == fault
    one = replace(system, switching=left_within((1, None), (dwell, None)))
    assert evidence.find_misfit(one) == fault


@pytest.mark.parametrize(
    ("leaving", "fault"),
    [
        ((), None),
        (("m0",), None),
        (("m0", "m0"), "the modes that must be left are not those of the system"),
        (("m3",), "the modes that must be left are not those of the system"),
        (("m0", "m1"), "a mode in which the function need not decrease has no longest dwell time"),
        (("m1", "m0"), "a mode in which the function need not decrease has no longest dwell time"),
    ],
)
def test_only_what_must_be_left_need_not_decrease(leaving, fault):
    system = family([[-1]], [[-1]], switching=left_within((0, 1)))
    assert scalars(1, 1, rate=HALF, leaving=leaving).find_misfit(system) == fault


@pytest.mark.parametrize("pieces", [1, 4096])
def test_pieces_within_the_limits(pieces):
    system, evidence = genuine("mode-quadratic, left in time")
    assert replace(evidence, pieces=pieces).find_misfit(system) is None


def test_the_most_pieces(monkeypatch):
    """Of three modes two are left, each in two ways."""
    system = family([[-1]], [[-1]], [[-1]], switching=left_within((1, 2), (1, 2)))
    evidence = scalars(1, 1, 1, rate=HALF, leaving=("m0", "m1"), pieces=5)
    monkeypatch.setattr(f"{MODULE}.MAX_ENCLOSED", 20)
    assert evidence.find_misfit(system) is None
    monkeypatch.setattr(f"{MODULE}.MAX_ENCLOSED", 19)
    assert evidence.find_misfit(system) == "the stays are enclosed in too few or too many pieces"


@pytest.mark.parametrize(("others", "is_refused"), [(64, False), (65, True)])
def test_more_pieces_than_can_be_enclosed(others, is_refused):
    """Of 4096 pieces, those of 64 switches are looked at."""
    ways = tuple(("m0", f"m{k + 1}") for k in range(others))
    rules = replace(left_within((1, 2)), transitions=ways)
    system = family(*[[[-1]]] * (others + 1), switching=rules)
    evidence = scalars(*[1] * (others + 1), rate=HALF, leaving=("m0",), pieces=4096)
    fault = "the stays are enclosed in too few or too many pieces"
    assert evidence.find_misfit(system) == (fault if is_refused else None)


@pytest.mark.parametrize(("bits", "is_refused"), [(10**6, False), (10**6 + 1, True)])
def test_longer_powers_than_can_be_formed(bits, is_refused):
    system = family([[2 ** (bits - 1)]], [[1]], time=Time.DISCRETE)
    fault = "the dwell time is too long for such large numbers" if is_refused else None
    assert scalars(1, 1, rate=HALF).find_misfit(system) == fault
    # One mode that is never left has no power.
    alone = replace(system, modes=system.modes[:1])
    assert scalars(1, rate=HALF).find_misfit(alone) is None


@pytest.mark.parametrize(("count", "is_refused"), [(2**20, False), (2**20 + 1, True)])
def test_more_ways_than_can_be_checked(count, is_refused):
    system = family([[-1]], [[-1]], switching=Switching(transitions=(("m0", "m1"),) * count))
    fault = "there are too many switches to check" if is_refused else None
    assert find_odd_switch(system) == fault


@pytest.mark.parametrize(
    ("system", "limit", "value"),
    [
        # The bits of the largest number, once for every step of the longest stay that counts.
        (family([[7]], [[1]], **IN_STEPS, switching=Switching(Fraction(4))), "POWER_BITS", 12),
        (family([[1]], [["1/4"]], **IN_STEPS, switching=Switching(Fraction(4))), "POWER_BITS", 12),
        (family([[-1]], [[1]], **IN_STEPS, switching=Switching(Fraction(4))), "POWER_BITS", 8),
        (family([[7]], [[1]], **IN_STEPS, switching=left_within((1, 4))), "POWER_BITS", 12),
        (
            family([[7]], [[1]], **IN_STEPS, switching=left_within((1, 2), (3, None))),
            "POWER_BITS",
            9,
        ),
        # The same for products of matrices, and for all stays in modes that are left.
        (family([[7]], [[1]], **IN_STEPS, switching=Switching(Fraction(4))), "WORK", 12),
        (
            family(
                [[7, 0], [0, 1]], [[1, 0], [0, 1]], **IN_STEPS, switching=Switching(Fraction(4))
            ),
            "WORK",
            8 * 12,
        ),
        (family([[7]], [[1]], **IN_STEPS, switching=left_within((1, 4))), "WORK", 3 * 10),
        (family([[7]], [[1]], [[1]], **IN_STEPS, switching=left_within((2, 4))), "WORK", 3 * 18),
    ],
)
def test_the_largest_powers(monkeypatch, system, limit, value):
    n = system.order
    Q = tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
    evidence = functions(*[Q] * len(system.modes), rate="1/2")
    if dict(system.switching.stays).get("m0", Stay()).longest is not None:
        evidence = replace(evidence, leaving=("m0",))
    monkeypatch.setattr(f"{MODULE}.MAX_{limit}", value)
    assert evidence.find_misfit(system) is None
    monkeypatch.setattr(f"{MODULE}.MAX_{limit}", value - 1)
    assert evidence.find_misfit(system) == "the dwell time is too long for such large numbers"


def test_the_rate_counts_among_the_numbers_of_a_power(monkeypatch):
    system = family([[1]], [[1]], **IN_STEPS, switching=Switching(Fraction(4)))
    evidence = scalars(1, 1, rate=Fraction(1, 8))
    monkeypatch.setattr(f"{MODULE}.MAX_POWER_BITS", 16)
    assert evidence.find_misfit(system) is None
    monkeypatch.setattr(f"{MODULE}.MAX_POWER_BITS", 15)
    assert "too long for such large numbers" in evidence.find_misfit(system)


RESETS = resets_between(("m0", "m1", [[1, 0], [0, 1]]), ("m1", "m0", [[1, 0], [0, 1]]))


@pytest.mark.parametrize(
    ("switching", "count"),
    [
        (Switching(), 6),
        (Switching(transitions=(("m0", "m1"), ("m1", "m2"))), 2),
        (Switching(resets=RESETS), 8),
        (Switching(transitions=(("m0", "m1"),), resets=RESETS), 3),
    ],
)
def test_the_most_switches(monkeypatch, switching, count):
    A = [[-1, 0], [0, -1]]
    system, fault = family(A, A, A, switching=switching), "there are too many switches to check"
    for limit, value in (("SWITCHES", count), ("WORK", count * 2**3)):
        with monkeypatch.context() as patch:
            patch.setattr(f"{MODULE}.MAX_{limit}", value)
            assert find_odd_switch(system) is None
            patch.setattr(f"{MODULE}.MAX_{limit}", value - 1)
            assert find_odd_switch(system) == fault


def test_a_switch_at_once_raises_nothing_and_a_later_one_may():
    """x' = -x, and half a second of it makes up for a function that is twice as large."""
    at_once, later = (Switching(Fraction(dwell), (("m0", "m1"),)) for dwell in ("0", "1/2"))
    raising = scalars(1, 2, rate=Fraction(1, 100))
    system = family([[-1]], [[-1]], switching=at_once)
    assert raising.find_fault(system) == "the switch from m0 to m1 raises the function"
    assert raising.find_fault(replace(system, switching=later)) is None
    assert scalars(2, 2, rate=Fraction(1, 100)).find_fault(system) is None


def test_a_mode_that_is_left_at_once_is_enclosed_from_the_beginning():
    left = replace(left_within((0, 1)), transitions=(("m0", "m1"),))
    system = family([[-1]], [[-1]], switching=left)
    for second, fault in ((1, None), (3, "after some stay, from m0 to m1 raises the function")):
        evidence = scalars(2, second, rate=Fraction(1, 100), leaving=("m0",), pieces=16)
        assert evidence.find_fault(system) == fault


def test_forms_of_steps_by_hand():
    """``rho^2k Q0 - (G A^k)^2 Q1`` for A = 1/3, G = 2/5, rho = 3/4, over ``(5 3^k 4^k)^2``."""
    resets = resets_between(("m0", "m1", [["2/5"]]))
    rules = replace(left_within((2, 3), (1, None)), resets=resets)
    system = family([["1/3"]], [["1/2"]], **IN_STEPS, switching=rules)
    evidence = scalars(7, 11, rate=Fraction(3, 4), leaving=("m0",))
    first, second, m1, two, three, back = (form[0][0] for _, form in evidence.forms(system))
    assert (first, second) == (7, 11)
    assert m1 == 2**2 * 4**2 * 11 * (Fraction(9, 16) - Fraction(1, 4))
    for k, form in ((2, two), (3, three)):
        decrease = Fraction(3, 4) ** (2 * k) * 7 - (Fraction(2, 5) / 3**k) ** 2 * 11
        assert form == (5 * 3**k) ** 2 * 4 ** (2 * k) * decrease
    assert back == 2**2 * 4**2 * (Fraction(9, 16) * 11 - Fraction(1, 4) * 7)
    words = [failure for failure, _ in evidence.forms(system)]
    assert words[2:] == [
        "V does not decrease at the claimed rate in mode m1",
        "after some stay, from m0 to m1 raises the function",
        "after some stay, from m0 to m1 raises the function",
        "after the dwell time, from m1 to m0 raises the function",
    ]
    assert [mode.name for mode in evidence.decreasing_modes(system)] == ["m1", "m0", "m0", "m1"]


def test_the_state_moves_before_it_is_reset():
    resets = resets_between(("m0", "m1", [[0, 1], [0, 0]]))
    rules = Switching(transitions=(("m0", "m1"),), resets=resets)
    system = family([[0, 0], ["1/2", 0]], [[0, 0], [0, 0]], **IN_STEPS, switching=rules)
    *_, (_, form) = functions(I2, I2, rate="3/4").forms(system)
    # A x = (0, x1/2), and the reset takes that to (x1/2, 0).
    assert form == [[9 * 4 - 16, 0], [0, 9 * 4]]


def test_pieces_of_a_stay(monkeypatch):
    asked = []

    def record(edge, times, Q, rate):
        asked.append((edge.source.name, *times))
        return ((1,),)

    monkeypatch.setattr(f"{MODULE}.enclosed_form", record)
    system = family([[1]], [[-2]], switching=left_within((HALF, 2), (3, 4)))
    evidence = scalars(1, 1, rate=HALF, leaving=("m0",), pieces=3)
    assert evidence.find_fault(system) is None
    ends = [HALF, Fraction(1), Fraction(3, 2), Fraction(2)]
    pieces = [("m0", *pair) for pair in pairwise(ends)]
    assert asked == [*pieces, ("m1", Fraction(3), Fraction(3))]


@pytest.mark.parametrize(
    ("switching", "time", "words"),
    [
        (Switching(), Time.CONTINUOUS, "arbitrary"),
        (Switching(HALF), Time.CONTINUOUS, "at least 0.5 s in each mode"),
        (Switching(Fraction(1)), Time.DISCRETE, "at least 1 step in each mode"),
        (Switching(Fraction(2)), Time.DISCRETE, "at least 2 steps in each mode"),
        (Switching(Fraction(1)), Time.CONTINUOUS, "at least 1 s in each mode"),
        (left_within((0, 1)), Time.CONTINUOUS, "at most 1 s in m0"),
        (left_within((0, 1)), Time.DISCRETE, "at most 1 step in m0"),
        (left_within((1, 3)), Time.DISCRETE, "1 to 3 steps in m0"),
        (
            left_within((1, None), dwell_time=HALF),
            Time.CONTINUOUS,
            "at least 0.5 s in each other mode, at least 1 s in m0",
        ),
        (
            left_within(*[(1, None)] * 8),
            Time.CONTINUOUS,
            ", ".join(f"at least 1 s in m{k}" for k in range(8)),
        ),
        (
            left_within(*[(1, None)] * 9),
            Time.CONTINUOUS,
            ", ".join(f"at least 1 s in m{k}" for k in range(8))
            + ", 9 modes with dwell times of their own",
        ),
        (Switching(transitions=()), Time.CONTINUOUS, "0 allowed transitions"),
        (
            Switching(transitions=(("m0", "m1"),), resets=RESETS),
            Time.CONTINUOUS,
            "1 allowed transition, 2 resets",
        ),
        (
            Switching(transitions=(("m0", "m1"), ("m1", "m0")), resets=RESETS[:1]),
            Time.CONTINUOUS,
            "2 allowed transitions, 1 reset",
        ),
    ],
)
def test_words_for_the_signals(switching, time, words):
    system = family([[-1]], [[-1]], time=time, switching=switching)
    assert signals_of(system) == words
    law = "x' = A x" if time is Time.CONTINUOUS else "x+ = A x"
    bound = "exp(-alpha t)" if time is Time.CONTINUOUS else "rho^t"
    claim = functions(((1,),), ((1,),), rate="1/2").claim(system)
    assert f"Every solution of {law} under the declared switching ({words})" in claim
    assert f"satisfies |x(t)| <= c {bound} |x(0)|" in claim


def test_a_file_without_pieces_has_one():
    system, evidence = genuine("mode-quadratic, dwell")
    found = read_evidence({"kind": evidence.kind, **evidence.to_fields()}, system)
    assert (found.leaving, found.pieces) == ((), 1)
    fields = {"kind": evidence.kind, **evidence.to_fields()}
    fields["functions"][0]["Q"]["denominator_log2"] += 1
    with pytest.raises(ValueError, match="do not share one denominator"):
        read_evidence(fields, system)
    with pytest.raises(ValueError, match="do not share one denominator"):
        read_evidence({**fields, "functions": []}, system)


@pytest.mark.parametrize(
    ("rate", "time", "decays"),
    [
        ("1/9", Time.CONTINUOUS, True),
        ("0", Time.CONTINUOUS, False),
        ("-1/9", Time.CONTINUOUS, False),
        ("8/9", Time.DISCRETE, True),
        ("1", Time.DISCRETE, False),
        ("10/9", Time.DISCRETE, False),
        ("-8/9", Time.DISCRETE, False),
    ],
)
def test_the_rate_is_one_of_decay(rate, time, decays):
    system = family([["-1/2"]], [["-1/2"]], time=time)
    evidence = scalars(1, 1, rate=Fraction(rate))
    assert evidence.pieces == 1
    fault = None if decays else "the claimed rate is not one of exponential decay"
    assert evidence.find_misfit(system) == fault


def test_a_switch_at_once_is_seen_after_one_that_comes_later():
    rules = Switching(stays=(("m0", Stay(HALF)),))
    system = family([[-1]], [[-1]], switching=rules)
    raising = scalars(2, 1, rate=Fraction(1, 100))
    assert raising.find_misfit(system) == "the switch from m1 to m0 raises the function"
    other = replace(rules, stays=(("m1", Stay(HALF)),))
    assert raising.find_misfit(replace(system, switching=other)) is None


def test_no_power_is_formed_in_continuous_time(monkeypatch):
    monkeypatch.setattr(f"{MODULE}.MAX_POWER_BITS", 0)
    system = family([[-1]], [[-1]], switching=Switching(Fraction(4)))
    assert scalars(1, 1, rate=HALF).find_misfit(system) is None


@pytest.mark.parametrize(("gain", "raises"), [("4/3", False), ("-4/3", False), ("1.34", True)])
def test_a_reset_counts_with_its_denominator(gain, raises):
    """``16 - (4/3)^2 9`` is zero."""
    rules = Switching(transitions=(("m0", "m1"),), resets=resets_between(("m0", "m1", [[gain]])))
    system = family([[-1]], [[-1]], switching=rules)
    fault = "the switch from m0 to m1 raises the function" if raises else None
    assert scalars(16, 9, rate=HALF).find_misfit(system) == fault
