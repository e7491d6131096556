"""Evidence of kind mode-quadratic: dwell times, transition graphs, resets, unequal modes."""

from dataclasses import replace
from fractions import Fraction
from time import process_time

import pytest

from nrs_design.proof.evidence import ModeQuadratic, read_evidence
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import Mode, Reset, Stay, Switching, Time
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
    start = process_time()
    assert functions(I2, I2).find_fault(system) is None
    coupled = family(
        [[-fast, fast], [-fast, -1]], [[-1, 1], [-1, -fast]], switching=Switching(Fraction(4096))
    )
    functions(I2, I2).find_fault(coupled)
    assert process_time() - start < 1


def test_hostile_dwell_times_rates_and_sizes_do_not_hang():
    n = 64
    A = [[(i * j) % 5 - 2 - 900 * (i == j) for j in range(n)] for i in range(n)]
    Q = tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
    slow = [[Fraction(entry, 1000) for entry in row] for row in A]
    start = process_time()
    for dwell in (4096, 4097, 10**30):
        system = family(slow, slow, time=Time.DISCRETE, switching=Switching(Fraction(dwell)))
        assert functions(Q, Q, rate="999/1000").find_fault(system) is not None
        small = family([["1/2"]], [["1/3"]], time=Time.DISCRETE, switching=system.switching)
        long_rate = str(Fraction(10**1999 - 1, 10**1999))
        assert functions(((1,),), ((1,),), rate=long_rate).find_fault(small) is not None
    assert process_time() - start < 3


def test_four_thousand_steps_of_a_small_system_are_checked():
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    system = family(*pair, time=Time.DISCRETE, switching=Switching(Fraction(4096)))
    evidence = functions(((1, 0), (0, 100)), ((100, 0), (0, 1)), rate="99/100")
    start = process_time()
    assert evidence.find_fault(system) is None
    assert process_time() - start < 2


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
    start = process_time()
    assert "too many switches" in functions(*[((1,),)] * 1200, rate="1/2").find_fault(system)
    assert process_time() - start < 2


def test_many_dwell_times_are_counted_and_not_listed():
    stays = tuple((f"m{i}", Stay(Fraction(1), None)) for i in range(9))
    system = family(*[[[-1]]] * 9, switching=Switching(stays=stays))
    claim = functions(*[((1,),)] * 9, rate="1/2").claim(system)
    assert "9 modes with dwell times of their own" in claim
