"""A closed sequence that grows: what is admissible, known answers, and what its numbers show.

The rows of test_growing_sequence.yaml are most of it.
"""

from contextlib import nullcontext
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from flint import arb, fmpq

from nrs_design.certificates.certificate import (
    CommonQuadraticStatus,
    common_quadratic_of,
    granted,
    refuted_in,
    refutes_in_contact,
    verdict_of,
)
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.contact import Flights
from nrs_design.proof.enclosure import precision
from nrs_design.proof.evidence import GrowingSequence, Shows, growing_sequence, read_evidence
from nrs_design.proof.evidence.growth import monodromy
from nrs_design.proof.exact import TooLargeError
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Verdict
from tests.proof import systems
from tests.support import ends_soon

HALF, ONE = Fraction(1, 2), Fraction(1)
STEPS = Time.DISCRETE


def in_contact(steps, factor):
    return GrowingSequence(tuple((name, Fraction(k)) for name, k in steps), factor=factor)


def mixed(*weights):
    return GrowingSequence(tuple((f"m{i}", Fraction(w)) for i, w in enumerate(weights)))


def signal(*steps, doublings=20):
    named = tuple((f"m{mode}", Fraction(dwell)) for mode, dwell in steps)
    return GrowingSequence(named, doublings)


GROWING = systems.family([[1, 1], [0, 1]], [[1, 0], [1, 1]], time=STEPS)
NOT_SHOWN = "the enclosure of the monodromy matrix does not show growth"
HUNDRED = systems.family([[int(i == j) for j in range(100)] for i in range(100)], time=STEPS)
LONGEST = signal(*[(0, 1), (1, 1)] * 512, doublings=0)


def test_a_spectral_radius_of_one_or_less_is_no_growth_however_often_it_is_squared():
    circle = systems.family([[0, 1], [-1, 0]])
    below = systems.family([["0.9999999", 0], [0, "1/2"]], time=STEPS)
    for k in range(61):
        systems.expect(below, signal((0, 1), doublings=k), NOT_SHOWN)
        if k % 6 == 0:
            systems.expect(circle, signal((0, "1.5"), doublings=k), NOT_SHOWN)
            systems.expect(replace(circle, time=STEPS), signal((0, 1), doublings=k), NOT_SHOWN)


def test_the_longest_signal_and_the_most_work(monkeypatch):
    longer = replace(LONGEST, steps=(*LONGEST.steps, ("m0", ONE)))
    systems.expect(GROWING, LONGEST, None)
    systems.expect(GROWING, longer, "does not cover")
    assert longer.find_misfit(GROWING) == "the sequence is empty or too long"
    too_long = "the sequence is too long for so many states"
    systems.expect(HUNDRED, signal(*[(0, 1)] * 5, doublings=0), NOT_SHOWN)
    systems.expect(HUNDRED, signal(*[(0, 1)] * 6, doublings=0), too_long)
    monkeypatch.setattr("nrs_design.proof.evidence.growing_sequence.MAX_WORK", 2 * 2**3)
    systems.expect(GROWING, signal((0, 1), (1, 1), doublings=2), None)
    monkeypatch.setattr("nrs_design.proof.evidence.growing_sequence.MAX_WORK", 2 * 2**3 - 1)
    systems.expect(GROWING, signal((0, 1), (1, 1), doublings=2), too_long)
    bounce = in_contact((("m0", growing_sequence.MAX_STEPS), ("free", 1)), (ONE, Fraction(2)))
    systems.expect(systems.juggling(), bounce, too_long)


LONG = ((1, 0), (0, 1)), ((2**400_000, 1), (0, 1))
TOO_LARGE = "the numbers of the average of the modes are too large to check"


@pytest.mark.parametrize(
    ("system", "evidence", "fault", "error"),
    [
        (
            systems.shears(),
            mixed(HALF + Fraction(1, 2**64 + 1), HALF - Fraction(1, 2**64 + 1)),
            "the weights have too many digits",
            TooLargeError,
        ),
        (
            systems.family([[1]], [[-1]]),
            GrowingSequence((("m0", Fraction(1, 3)),) * 3),
            "a mode is named twice in an average",
            TooLargeError,
        ),
        (systems.shears(), GrowingSequence((("m9", ONE),)), "do not exist", KeyError),
        *(
            (
                replace(
                    systems.shears(), modes=tuple(Mode(f"m{i}", A) for i, A in enumerate(matrices))
                ),
                mixed(HALF, HALF),
                TOO_LARGE,
                (ValueError, TooLargeError),
            )
            for matrices in (
                (RationalMatrix(LONG[0], 2**60_000), RationalMatrix(LONG[0], 3**40_000)),
                (RationalMatrix(LONG[1]), RationalMatrix(LONG[0])),
            )
        ),
    ],
    ids=("long", "thrice", "unknown", "coprime", "large"),
)
def test_what_is_read_is_said_in_words_before_it_is_checked(system, evidence, fault, error):
    systems.expect(system, evidence, fault)
    with pytest.raises(error) if error else nullcontext():
        evidence.claim(system)


def test_a_sequence_is_read_as_it_is_written():
    """With the reset that is taken, or the factor of a motion, where there is one."""
    system, two_ways = systems.genuine("growing-sequence, two ways")
    for evidence, fields in (
        (growing_sequence.staying("m0"), {"steps": [["m0", "1"]]}),
        (BOUNCE, {"steps": [["m0", "1"], ["free", "1"]], "factor": ["2427/1250", "19417/10000"]}),
    ):
        assert evidence.to_fields() == fields
        assert GrowingSequence.from_fields(fields, system) == evidence
    with pytest.raises(ValueError, match="zip"):
        GrowingSequence.from_fields({**BOUNCE.to_fields(), "factor": ["2"]}, system)
    fields = {"kind": two_ways.kind, **two_ways.to_fields()}
    assert fields["edges"] == [1, 0]
    assert "then reset 2 to m1, m1 for 1 steps)" in two_ways.claim(system)
    assert read_evidence(fields, system) == two_ways
    with pytest.raises(ValueError, match="one edge for each"):
        read_evidence({**fields, "edges": [1]}, system)
    assert "edges" not in systems.genuine("growing-sequence, period")[1].to_fields()


def test_the_order_of_time_is_that_of_the_steps():
    # From m0 to m1 the state is swapped, back it is left: only the order tells which is first.
    resets = systems.resets_between(("m0", "m1", [[0, 1], [0, 0]]))
    system = systems.family(
        [[2, 0], [0, "1/2"]],
        [["1/2", 0], [0, 4]],
        time=Time.DISCRETE,
        switching=Switching(resets=resets),
    )
    with precision():
        product = monodromy(system, signal((0, 1), (1, 1)).steps)
    expected = np.diag([0.5, 4]) @ np.array([[0, 1], [0, 0]]) @ np.diag([2, 0.5])
    found = [[float(product[i, j]) for j in range(2)] for i in range(2)]
    assert np.array_equal(np.array(found), expected)


def test_one_value_of_a_constant_parameter_refutes():
    rows = [mode.A.fractions() for mode in systems.branicky().modes]
    system = systems.family(
        rows[0], rows[1], rows[0], rows[1], switching=Switching(
            fixed_ends=(("m0", "m2"), ("m1", "m3"))
        )
    )  # fmt: skip
    _, evidence = systems.genuine("growing-sequence, period")
    assert evidence.find_fault(system) is None
    crossed = replace(evidence, steps=tuple(
        ({"m1": "m3"}.get(name, name), dwell) for name, dwell in evidence.steps
    ))  # fmt: skip
    assert crossed.find_fault(system) is not None


def test_enormous_modes_do_not_hang_or_overflow():
    for time in Time:
        system = systems.family([[-(10**200), 10**200], [-(10**200), -1]], time=time)
        with ends_soon():
            signal((0, 4096), doublings=60).find_fault(system)


def test_every_step_takes_its_own_reset():
    resets = systems.resets_between(("m0", "m1", [[2]]), ("m0", "m1", [[3]]))
    system = systems.family([[1]], [["1/5"]], time=STEPS, switching=Switching(resets=resets))
    steps = signal((0, 1), (1, 1), (0, 1), (1, 1)).steps
    for edges, factor in (((0, 0, 0, 0), 4), ((1, 0, 0, 0), 6), ((1, 0, 1, 0), 9)):
        with precision():
            assert monodromy(system, steps, edges)[0, 0].contains(arb(fmpq(factor, 25)))


BOUNCE = in_contact((("m0", 1), ("free", 1)), (Fraction(19416, 10000), Fraction(19417, 10000)))


def test_growth_in_contact_says_nothing_of_a_common_function_unless_it_is_of_one_mode():
    system = systems.juggling()
    assert BOUNCE.shown(system) is BOUNCE.shows is Shows.INSTABILITY
    assert verdict_of(system, (BOUNCE,)) is Verdict.REFUTED
    assert common_quadratic_of(system, (BOUNCE,)) is CommonQuadraticStatus.UNKNOWN
    drawn = in_contact((("m0", 1),), (Fraction(999, 1000), Fraction(1001, 1000)))
    assert common_quadratic_of(systems.sucking_in(), (drawn,)) is CommonQuadraticStatus.IMPOSSIBLE
    digits = 2 - Fraction(1, growing_sequence.MAX_FACTOR_DENOMINATOR + 1)
    systems.expect(system, replace(BOUNCE, factor=(BOUNCE.factor[0], digits)), "too many digits")


def test_the_signs_of_the_other_eigenvalue_count_for_themselves():
    """The sequence has a second eigenvalue beyond one, with an eigenvector of its own."""
    system = systems.juggling()
    A, F = (np.array(m.A.floats()) for m in (*system.modes, *system.contact.free))
    values, vectors = np.linalg.eig(F @ A)
    for value, v in zip(values, vectors.T, strict=True):
        if not (abs(value.imag) < 1e-12 and value.real > 1):
            continue
        near = Fraction(value.real).limit_denominator(10**9)
        factor = (near - Fraction(1, 10**8), near + Fraction(1, 10**8))
        keeps = v.real[-1] * (A @ v.real)[-1] < 0
        assert (replace(BOUNCE, factor=factor).find_fault(system) is None) == keeps


A, LOST = Assumption("a.kind"), Assumption("lost.so")


def test_growth_in_kept_contact_alone_is_a_statement_of_its_own():
    system = systems.juggling()
    system = replace(system, assumptions=(A,), contact=replace(system.contact, loss=LOST))
    kept = growing_sequence.staying("m0")
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
    system = systems.juggling_among_modes()
    kept = growing_sequence.staying("m0")
    assert kept.shown(system) is Shows.INSTABILITY_IN_CONTACT
    assert refuted_in(system, (kept,)) == "where contact is lost and made at any deflection"
    assert "at any deflection" in kept.claim(system)
    assert "at any deflection" not in BOUNCE.claim(system)
    # A mode that is the same in contact and free needs no sign.
    same = replace(system, flights=Flights((), ("free",)))
    assert kept.shown(same) is Shows.INSTABILITY
    assert kept.claim(same) == kept.claim_in_scope(same)


def test_free_motion_that_is_not_stable_refutes():
    system = systems.drifting()
    evidence = growing_sequence.staying("free")
    assert evidence.find_fault(system) is None
    assert evidence.shown(system) is Shows.INSTABILITY
    assert "the deflection aside" in evidence.claim(system)
    assert GrowingSequence.from_fields(evidence.to_fields(), system) == evidence
    assert common_quadratic_of(system, (evidence,)) is CommonQuadraticStatus.UNKNOWN
    kept = replace(system, contact=replace(system.contact, required=False))
    assert "do not exist" in evidence.find_fault(kept)
    assert systems.juggling_in_turns().free_motions() == kept.free_motions() == ()
    # At rest in the air, a deflection stays what it is: that is no instability.
    assert "is stable" in growing_sequence.staying("free").find_fault(
        replace(
            systems.bouncing_in_steps(),
            contact=replace(systems.bouncing_in_steps().contact, required=True),
        )
    )


def test_a_mode_decides_where_contact_is_kept_and_in_the_air():
    for system, mode, expected in (
        (systems.juggling(), "m0", False),
        (replace(systems.juggling(), contact=None), "m0", True),
        (systems.drifting(), "free", True),
    ):
        assert growing_sequence.decides(system, mode) is expected


def test_growth_that_keeps_the_signs_is_that_of_all_that_is_enclosed():
    system, evidence = systems.genuine("growing-sequence, contact")
    assert evidence.factor is not None
    assert evidence.find_fault(system) is None
    name = evidence.steps[0][0]
    mode = next(mode for mode in system.every_mode if mode.name == name)
    still = Mode("still", systems.matrix([[v / 2 for v in row] for row in mode.A.fractions()]))
    system = replace(system, modes=(*system.modes, still), enclosures=((name, "still"),))
    assert "does not show a growing motion" in evidence.find_fault(system)


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
        GrowingSequence.from_fields(fields, systems.family([[1]]))
