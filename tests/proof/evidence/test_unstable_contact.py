"""Growth while contact is lost and made: every sign and the factor are needed, and decided."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.certificates.certificate import (
    CommonQuadraticStatus,
    Verdict,
    common_quadratic_of,
    granted,
    refuted_in,
    refutes_in_contact,
    verdict_of,
)
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.evidence import Shows, UnstableContact, UnstableMode, UnstablePeriod
from nrs_design.proof.evidence.unstable_contact import MAX_DENOMINATOR, MAX_STEPS
from nrs_design.proof.evidence.unstable_mode import decides, free_motions
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Clock, Reset, Stay, Switching
from tests.proof.systems import (
    bouncing_in_steps,
    drifting,
    family,
    genuine,
    juggling,
    juggling_among_modes,
    juggling_in_turns,
    matrix,
    sucking_in,
    sucking_in_steps,
)

ONCE = (("m0", 1), ("free", 1))
FACTOR = (Fraction(19, 10), Fraction(2))
NARROW = (Fraction(19416, 10000), Fraction(19417, 10000))
BOUNCE = UnstableContact(ONCE, NARROW)
NO_SIGNS = "the enclosure does not show a growing motion that keeps the signs of contact"


def test_one_step_of_contact_and_one_of_flight():
    system = juggling()
    assert BOUNCE.find_fault(system) is None
    assert BOUNCE.shown(system) is BOUNCE.shows is Shows.INSTABILITY
    assert verdict_of(system, (BOUNCE,)) is Verdict.REFUTED
    # Its modes in contact may share a function: nothing is said of that.
    assert common_quadratic_of(system, (BOUNCE,)) is CommonQuadraticStatus.UNKNOWN
    twice = UnstableContact(ONCE * 2, tuple(number**2 for number in NARROW))
    assert twice.find_fault(system) is None
    assert UnstableContact(ONCE[::-1], NARROW).find_fault(system) is None


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
        (ONCE, (NARROW[0], Fraction(2) - Fraction(1, MAX_DENOMINATOR + 1)), "too many digits"),
        ((), NARROW, "does not cover this kind of switching"),
        ((("m0", 0), ("free", 1)), NARROW, "empty or too long"),
        ((("m0", MAX_STEPS), ("free", 1)), NARROW, "empty or too long"),
        ((("m0", 1), ("fre", 1)), NARROW, "modes that do not exist"),
    ],
)
def test_what_is_no_witness(steps, factor, fault):
    assert fault in UnstableContact(steps, factor).find_fault(juggling())


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
        assert (UnstableContact(ONCE, factor).find_fault(system) is None) == keeps


def test_where_the_signs_are_against_it_there_is_no_witness():
    """With contact where the deflection is negative, the same growth pulls."""
    system = juggling()
    turned = [[-1 if (i == 2) != (j == 2) else 1 for j in range(3)] for i in range(3)]

    def other(mode):
        rows = mode.A.fractions()
        signed = [[s * e for s, e in zip(*r, strict=True)] for r in zip(turned, rows, strict=True)]
        return Mode(mode.name, matrix(signed))

    contact = replace(system.contact, free=tuple(map(other, system.contact.free)))
    mirrored = replace(system, modes=tuple(map(other, system.modes)), contact=contact)
    # The mirror of a linear motion is one, with the opposite sign: v and -v both count.
    assert BOUNCE.find_fault(mirrored) is None
    swapped = replace(
        system,
        modes=(Mode("m0", system.contact.free[0].A),),
        contact=replace(
            system.contact, free=(Mode("free", matrix([[0, 0, 0]] * 2 + [[1, 0, 1]])),)
        ),
    )
    assert NO_SIGNS in BOUNCE.find_fault(swapped)


def test_it_is_asked_for_only_where_the_loss_of_contact_must_be_covered():
    system = juggling()
    kept = replace(system, contact=replace(system.contact, required=False))
    for other in (kept, replace(system, contact=None)):
        assert "does not ask for the loss" in BOUNCE.find_fault(other)


def test_a_mode_that_draws_in():
    steps = UnstableContact((("m0", 1),), (Fraction(13, 10), Fraction(4, 3)))
    narrow = replace(steps, factor=(Fraction(13090, 10**4), Fraction(13091, 10**4)))
    assert narrow.find_fault(sucking_in_steps()) is None
    continuous = UnstableContact((("m0", 1),), (Fraction(999, 1000), Fraction(1001, 1000)))
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
    system, evidence = genuine("unstable-contact, pulling")
    pulls = tuple(matrix([[-1, 0]]) for _ in range(2))
    assert NO_SIGNS in evidence.find_fault(
        replace(system, contact=replace(system.contact, pulls=pulls))
    )
    # A flight with a positive deflection, where the force of the moment would pull.
    free = Mode("free", matrix([["3/2", 0], [1, 1]]))
    lagging = replace(sucking_in_steps(), contact=Contact((free,), (matrix([[-2, 1]]),), True))
    flight = UnstableContact((("free", 1),), (Fraction(149, 100), Fraction(151, 100)))
    assert flight.find_fault(lagging) is None
    for pull in ([[-1, 1]], [[0, 1]]):
        other = replace(lagging, contact=replace(lagging.contact, pulls=(matrix(pull),)))
        # Downwards the deflection is negative: that is a flight, too.
        assert flight.find_fault(other) is None


def test_rules_of_switching_are_kept():
    system, evidence = genuine("unstable-contact, among modes")
    assert evidence.find_fault(system) is None
    for rules in (
        Switching(transitions=(("m0", "free"),)),
        Switching(dwell_time=Fraction(2)),
        Switching(stays=(("m0", Stay(Fraction(2))),)),
        Switching(resets=(Reset("m0", "free", matrix([[1, 0, 0], [0, 1, 0], [0, 0, 1]])),)),
    ):
        assert "does not cover" in evidence.find_fault(replace(system, switching=rules))
    forever = UnstableContact((("m0", 1),), NARROW)
    assert forever.fits(Switching(resets=(Reset("m0", "free", matrix([[1]])),)))
    assert not forever.fits(Switching(stays=(("m0", Stay(Fraction(1), Fraction(2))),)))
    both = Switching(transitions=(("m0", "free"), ("free", "m0")))
    assert evidence.find_fault(replace(system, switching=both)) is None


def test_modes_take_their_turns():
    system = juggling_in_turns()
    assert UnstableContact((("m0", 1), ("free again", 1)), NARROW).find_fault(system) is None
    assert "not its turn" in BOUNCE.find_fault(system)
    third = replace(system, clock=Clock(3, ("m0", "free")))
    late = UnstableContact((("m0", 1), ("free again", 1)), NARROW)
    assert "not its turn" in late.find_fault(third)


def test_long_sequences_of_many_states_are_not_followed():
    n = 30
    rows = [[int(i == j) for j in range(n)] for i in range(n)]
    system = family(rows, time=Time.DISCRETE)
    system = replace(system, contact=Contact((Mode("free", matrix(rows)),), required=True))
    long = UnstableContact((("m0", 1000),), NARROW)
    assert "too long for so many states" in long.find_fault(system)


def test_words_and_fields():
    system = juggling()
    assert BOUNCE.claim(system) == (
        "Repeating the sequence (m0 for 1 steps, free for 1 steps) makes some motion larger by a "
        "factor = 1.9416 each time. Wherever the environment acts, the deflection is positive "
        "along it and nothing pulls, and elsewhere it is not, so contact is lost and made as that "
        "motion says, and x+ = A x is unstable with contact that may be lost."
    )
    fields = BOUNCE.to_fields()
    assert fields == {"steps": [["m0", 1], ["free", 1]], "factor": ["2427/1250", "19417/10000"]}
    assert UnstableContact.from_fields(fields, system) == BOUNCE
    with pytest.raises(ValueError, match="unpack"):
        UnstableContact.from_fields({**fields, "factor": ["2"]}, system)


def test_growth_in_kept_contact_alone_is_a_statement_of_its_own():
    system = juggling()
    system = replace(system, assumptions=("a",), contact=replace(system.contact, loss="lost so"))
    kept = UnstableMode("m0", "-1")
    period = UnstablePeriod((("m0", Fraction(1)),), 4)
    for evidence in (kept, period):
        assert evidence.shown(system) is Shows.INSTABILITY_IN_CONTACT
        assert verdict_of(system, (evidence,)) is Verdict.INCONCLUSIVE
        assert refuted_in(system, (evidence,)) == "in kept contact"
        assert refutes_in_contact(system, (evidence,)) is evidence
        # What it does not cover, it does not take for granted.
        assert granted(system, (evidence,)) == ("a",)
        assert evidence.claim(system).endswith("the environment pulling as it pushes.")
        assert common_quadratic_of(system, (evidence,)) is CommonQuadraticStatus.IMPOSSIBLE
    assert refuted_in(system, (kept, BOUNCE)) is refuted_in(system, ()) is None
    assert verdict_of(system, (kept, BOUNCE)) is Verdict.REFUTED
    assert granted(system, (BOUNCE,)) == granted(system, ()) == ("a", "lost so")
    may = replace(system, contact=replace(system.contact, required=False))
    assert verdict_of(may, (kept,)) is Verdict.REFUTED
    assert granted(replace(system, contact=None), (kept,)) == ("a",)


def test_where_free_motion_is_among_the_modes_signs_count_too():
    system = juggling_among_modes()
    kept = UnstableMode("m0", "-1")
    assert kept.shown(system) is Shows.INSTABILITY_IN_CONTACT
    assert refuted_in(system, (kept,)) == "where contact is lost and made at any deflection"
    assert "at any deflection" in kept.claim(system)
    assert BOUNCE.find_fault(system) is None
    assert "at any deflection" not in BOUNCE.claim(system)
    # A mode that is the same in contact and free needs no sign.
    same = replace(system, flights=Flights((), ("free",)))
    assert kept.shown(same) is Shows.INSTABILITY
    assert kept.claim(same) == kept.claim_in_scope(same)
    assert UnstableContact((("m0", 1),), NARROW).find_fault(same) is not None
    assert replace(BOUNCE, steps=ONCE[::-1]).find_fault(same) is None


def test_free_motion_that_is_not_stable_refutes():
    system = drifting()
    evidence = UnstableMode("free", "1")
    assert evidence.find_fault(system) is None
    assert evidence.shown(system) is Shows.INSTABILITY
    assert "the deflection aside" in evidence.claim(system)
    assert UnstableMode.from_fields(evidence.to_fields(), system) == evidence
    assert common_quadratic_of(system, (evidence,)) is CommonQuadraticStatus.UNKNOWN
    kept = replace(system, contact=replace(system.contact, required=False))
    assert "no single mode" in evidence.find_fault(kept)
    assert free_motions(juggling_in_turns()) == free_motions(kept) == ()
    # At rest in the air, a deflection stays what it is: that is no instability.
    assert "is stable" in UnstableMode("free", "1").find_fault(
        replace(bouncing_in_steps(), contact=replace(bouncing_in_steps().contact, required=True))
    )


def test_a_mode_decides_where_contact_is_kept_and_in_the_air():
    for system, mode, expected in (
        (juggling(), "m0", False),
        (replace(juggling(), contact=None), "m0", True),
        (drifting(), "free", True),
    ):
        assert decides(system, mode) is expected
