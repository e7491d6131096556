"""Functions of each mode for contact and free motion: known answers, attacks, what is barred."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import ConewiseModeQuadratic, ConewiseQuadratic, Shows
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.system import SwitchedSystem
from tests.proof.evidence.test_conewise_quadratic import ESCAPES, growth, losable, over
from tests.proof.systems import bouncing, bouncing_in_steps, family, genuine, matrix
from tests.proof.truth import (
    combine,
    holds,
    is_in_other_units,
    is_positive_multiple,
    times,
    transpose,
)
from tests.support import broken

Q = ((40, 20), (20, 60))
# By hand, as for one function: all modes have the same.
STEPS = ConewiseModeQuadratic(
    (("m0", Q), ("m1", Q)), (("free", ((40,),)),), 0, Fraction(99, 100), (16,)
)


def test_a_bouncing_mass_is_proved():
    system, proposed = genuine("conewise-mode-quadratic")
    for evidence in (STEPS, proposed):
        assert evidence.find_fault(system) is None
        assert agrees(system, evidence)
        assert holds(system, evidence)
        assert evidence.shows is Shows.STABILITY
        assert evidence.proved_rate(system) == evidence.rate
        claim = evidence.claim(system)
        assert "contact lost and made again at any time" in claim
        assert "2 modes in contact and 1 mode of free motion" in claim
        assert "as long as contact is kept" not in claim


def test_one_function_written_for_every_mode_has_the_same_conditions():
    system = bouncing_in_steps()
    one = ConewiseQuadratic(Q, 0, Fraction(99, 100), (16,))
    every = [form for _, form in STEPS.forms(system)]
    for _, form in one.forms(system):
        assert any(is_in_other_units(form, other) for other in every)


# With the block of y as the function of free motion, a step there is one of two equal conditions.
@pytest.mark.parametrize("where", [where for where in ESCAPES if "free motion" not in where])
def test_each_condition_bars_a_family_that_grows(where):
    """The families of one function, and that function for every mode."""
    contact, free, rows = ESCAPES[where]
    system = losable(contact, free, Time.DISCRETE)
    whole = tuple(tuple(64 * entry for entry in row) for row in rows)
    block = tuple(row[:-1] for row in whole[:-1])
    faults = set()
    for multiplier in (0, 16, 32, 64, 128, 256, 512):
        candidate = ConewiseModeQuadratic(
            (("m0", whole),), (("f", block),), 0, Fraction(98, 100), (multiplier,)
        )
        found = broken(system, candidate)
        assert any(failure.startswith(where) for failure in found)
        faults.add(frozenset(f.partition(",")[0].removesuffix(" at the surface") for f in found))
    named = where.partition(",")[0]
    assert frozenset({named}) in faults


def test_a_step_of_free_motion_is_a_condition_of_its_own():
    """The velocity doubles and the surface is never reached; contact would stop all motion."""
    system = losable([[0, 0], [0, 0]], [[2, 0], [0, 1]], Time.DISCRETE)
    candidate = ConewiseModeQuadratic(
        (("m0", ((1, 0), (0, 1))),), (("f", ((100,),)),), 0, Fraction(99, 100), (0,)
    )
    assert broken(system, candidate) == {"in free motion, mode f, then f"}
    assert "in free motion" in candidate.find_fault(system)


def test_landing_at_the_surface_is_a_condition_of_its_own():
    """A family that grows, with functions that keep all but that. Found by a random search."""
    contact = over(16, (-16, 13, 11), (-15, 8, 12), (-17, 6, 7))
    system = losable(contact, over(16, (-9, 4, 0), (13, 13, 0), (-14, 1, 16)), Time.DISCRETE)
    whole = ((2195, -1026, -1348), (-1026, 876, 758), (-1348, 758, 988))
    candidate = ConewiseModeQuadratic(
        (("m0", whole),), (("f", ((738, 184), (184, 554))),), 0, Fraction(995, 1000), (0,)
    )
    assert broken(system, candidate) == {"where contact is made at the surface, mode f, then m0"}
    assert "at the surface" in candidate.find_fault(system)
    assert max(growth(system, whole, start) for start in range(40)) > 1000


def test_steps_from_one_mode_to_another_are_conditions_of_their_own():
    """Each mode decreases its own function, and alternating grows."""
    free = Contact((Mode("f", matrix([[0, 0], [0, 1]])),))
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    system = replace(family(*pair, time=Time.DISCRETE), contact=free)
    wide, tall = ((1, 0), (0, 100)), ((100, 0), (0, 1))
    candidate = ConewiseModeQuadratic(
        (("m0", wide), ("m1", tall)), (("f", ((1,),)),), 0, Fraction(9, 10), (0,)
    )
    assert broken(system, candidate) == {"in mode m0, then m1", "in mode m1, then m0"}
    assert "then m" in candidate.find_fault(system)
    # The product of the two has the trace 4.5, above two, and positive entries: contact is kept.


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"touching": STEPS.touching[:1]}, "one function for each mode"),
        ({"touching": STEPS.touching[::-1]}, "one function for each mode"),
        ({"flying": ()}, "one function for each mode"),
        ({"touching": (("m0", ((1,),)), STEPS.touching[1])}, "not a 2 x 2"),
        ({"flying": (("free", Q),)}, "not a 1 x 1"),
        ({"touching": (("m0", ((40, 20), (19, 60))), STEPS.touching[1])}, "not symmetric"),
        ({"flying": (("free", ((-40,),)),)}, "not symmetric and positive"),
        ({"rate": Fraction(0)}, "exponential decay"),
        ({"rate": Fraction(1)}, "exponential decay"),
        ({"multipliers": ()}, "multiplier"),
        ({"multipliers": (-1,)}, "multiplier"),
    ],
)
def test_misfits(changes, fault):
    assert fault in replace(STEPS, **changes).find_fault(bouncing_in_steps())


def test_what_is_not_covered_is_refused():
    steps = bouncing_in_steps()
    assert "how contact is lost" in STEPS.find_fault(replace(steps, contact=None))
    pulled = replace(steps, contact=Contact(steps.contact.free, (matrix([[1, 1]]),)))
    assert "could pull" in STEPS.find_fault(pulled)
    assert "discrete time" in STEPS.find_fault(bouncing())


def test_equal_modes_repeat_their_functions():
    system, evidence = genuine("conewise-mode-quadratic")
    again = tuple(replace(mode, name=f"{mode.name} again") for mode in system.modes)
    twice = replace(system, modes=(*system.modes, *again))
    assert evidence.spread(system, twice).find_fault(twice) is None


def test_numbers_survive_a_file():
    system, evidence = genuine("conewise-mode-quadratic")
    fields = evidence.to_fields()
    assert ConewiseModeQuadratic.from_fields(fields, system) == evidence
    with pytest.raises(ValueError, match="how contact is lost"):
        ConewiseModeQuadratic.from_fields(fields, replace(system, contact=None))
    fields["flying"][0]["Q"]["denominator_log2"] += 1
    with pytest.raises(ValueError, match="one denominator"):
        ConewiseModeQuadratic.from_fields(fields, system)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.integers(-6, 6), min_size=8, max_size=8),
    st.tuples(st.integers(-7, 7), st.integers(-8, 8)),
    st.lists(st.integers(-3, 3), min_size=2, max_size=2),
    st.lists(st.integers(1, 9), min_size=5, max_size=5),
    st.integers(0, 3),
    st.sampled_from([Fraction(1, 2), Fraction(99, 100)]),
)
def test_against_the_definition(contact, free, sides, diagonal, multiplier, rate):
    """The definition in fractions, decided by another elimination."""
    a, b, c, d, e, f, g, h = (Fraction(entry, 8) for entry in contact)
    ends = [[a, b], [c, d]], [[e, f], [g, h]]
    motion = Mode("f", matrix([[Fraction(free[0], 8), 0], [Fraction(free[1], 8), 1]]))
    system = replace(family(*ends, time=Time.DISCRETE), contact=Contact((motion,)))
    p, q, r, s, t = diagonal
    functions = ("m0", ((p, sides[0]), (sides[0], q))), ("m1", ((r, sides[1]), (sides[1], s)))
    candidate = ConewiseModeQuadratic(functions, (("f", ((t,),)),), 0, rate, (multiplier,))
    assert (candidate.find_fault(system) is None) == holds(system, candidate)


@given(st.fractions(0, 1), st.fractions(0, 1), st.fractions(0, 1))
def test_combinations_of_modes_keep_the_functions_that_belong_to_them(now, then, depth):
    """A stiffness between its ends: it decreases all the same, landing at any depth."""
    system, evidence = genuine("conewise-mode-quadratic")
    ends = [mode.A.fractions() for mode in system.modes]
    free = system.contact.free[0].A.fractions()

    def mixed(share, first, second):
        return [
            [(1 - share) * x + share * y for x, y in zip(*rows, strict=True)]
            for rows in zip(first, second, strict=True)
        ]

    def V(form, x):
        return sum(a * b * y for a, row in zip(x, form, strict=True)
                   for b, y in zip(row, x, strict=True))  # fmt: skip

    (_, Q0), (_, Q1) = evidence.touching
    (_, R), square = evidence.flying[0], evidence.rate**2
    A, before, after = mixed(now, *ends), mixed(now, Q0, Q1), mixed(then, Q0, Q1)
    for v in (Fraction(-3), Fraction(-1), Fraction(0), Fraction(2)):
        x = [v, Fraction(1)]
        moved = [sum(a * b for a, b in zip(row, x, strict=True)) for row in A]
        value = V(after, moved) if moved[1] > 0 else V(R, moved[:1])
        assert value < square * V(before, x)
        flown = [free[0][0] * v, max(free[1][0] * v, Fraction(0)) * depth]
        if v:
            assert V(after, flown) < square * V(R, [v])


# Of three states, with denominators that differ, and nothing symmetric but the functions.
MAPS3 = (
    [["-1/2", "1/3", "2/3"], [1, "-1/5", "-3/7"], ["1/4", "2/3", "-1/9"]],
    [["-1/11", "2/3", "1/8"], ["-1/5", -2, 1], ["5/4", "1/6", "1/3"]],
    [["-1/3", "1/2", 0], ["1/7", "-2/5", 0], ["3/4", "-1/6", 1]],
    [["1/8", "-1/2", 0], ["2/7", "1/5", 0], ["-1/4", "5/6", 1]],
)
WHOLE = (("m0", ((9, 2, -1), (2, 7, 3), (-1, 3, 8))), ("m1", ((6, 1, 2), (1, 5, -2), (2, -2, 7))))
BLOCKS = (("f", ((4, 1), (1, 3))), ("g", ((5, -2), (-2, 6))))
THREE = ConewiseModeQuadratic(WHOLE, BLOCKS, 0, Fraction(6, 7), (5, 3))


def three_states() -> SwitchedSystem:
    free = (Mode("f", matrix(MAPS3[2])), Mode("g", matrix(MAPS3[3])))
    return replace(family(*MAPS3[:2], time=Time.DISCRETE), contact=Contact(free))


def test_every_form_by_hand():
    exact, keeps, wanted = [matrix(A).fractions() for A in MAPS3], Fraction(6, 7) ** 2, {}

    def decrease(before, N, after):
        return combine((keeps, before), (-1, times(transpose(N), times(after, N))))

    for k, (name, own) in enumerate(WHOLE):
        A = exact[k]
        for after, other in WHOLE:
            wanted[f"in mode {name}, then {after}"] = decrease(own, A, other)
        for (after, block), weight in zip(BLOCKS, (5, 3), strict=True):
            crossing = [
                [(i == 2) * A[2][j] + (j == 2) * A[2][i] for j in range(3)] for i in range(3)
            ]
            form = combine((1, decrease(own, A[:2], block)), (weight, crossing))
            wanted[f"where contact is lost in mode {name}, then {after}"] = form
    for k, (name, own) in enumerate(BLOCKS, 2):
        A = [row[:2] for row in exact[k]]
        for after, other in BLOCKS:
            wanted[f"in free motion, mode {name}, then {after}"] = decrease(own, A[:2], other)
        for after, other in WHOLE:
            inner = [row[:2] for row in other[:2]]
            end = f"mode {name}, then {after}"
            wanted[f"where contact is made, {end}"] = decrease(own, A, other)
            wanted[f"where contact is made at the surface, {end}"] = decrease(own, A[:2], inner)
    assert THREE.find_misfit(three_states()) is None
    forms = {failure.partition("rate ")[2]: form for failure, form in THREE.forms(three_states())}
    named = [
        f"the function of mode {name} is not symmetric and positive definite"
        for name in ("m0", "m1", "f", "g")
    ]
    assert [failure for failure, _ in THREE.forms(three_states())][:4] == named
    assert forms.pop("") == BLOCKS[1][1]
    assert forms.keys() == wanted.keys()
    for where, form in forms.items():
        assert is_positive_multiple(form, wanted[where]), where


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({}, None),
        ({"multipliers": (0, 0)}, None),
        ({"multipliers": (5, -1)}, "there is not one multiplier >= 0 for each free mode"),
        ({"multipliers": (-1, 5)}, "there is not one multiplier >= 0 for each free mode"),
        ({"multipliers": (5,)}, "there is not one multiplier >= 0 for each free mode"),
        ({"multipliers": (5, 5, 5)}, "there is not one multiplier >= 0 for each free mode"),
        ({"touching": (WHOLE[0], ("m1", ((1,),)))}, "a function in contact is not a 3 x 3 matrix"),
        (
            {"flying": (BLOCKS[0], ("g", ((1,),)))},
            "a function of free motion is not a 2 x 2 matrix",
        ),
        ({"flying": BLOCKS[::-1]}, "there is not one function for each mode"),
        ({"rate": Fraction(1)}, "the claimed rate is not one of exponential decay"),
    ],
)
def test_what_fits_three_states(changes, fault):
    assert replace(THREE, **changes).find_misfit(three_states()) == fault


def test_the_most_modes(monkeypatch):
    limit = "nrs_design.proof.evidence.conewise_mode_quadratic.MAX_WORK"
    monkeypatch.setattr(limit, 2 * 4**2 * 3**3)
    assert THREE.find_misfit(three_states()) is None
    monkeypatch.setattr(limit, 2 * 4**2 * 3**3 - 1)
    assert THREE.find_misfit(three_states()) == "there are too many modes to check"


def test_a_claim_and_a_file_of_three_states():
    system = three_states()
    assert "among 2 modes in contact and 2 modes of free motion" in THREE.claim(system)
    one = replace(THREE, touching=WHOLE[:1], flying=BLOCKS[:1])
    assert "among 1 mode in contact and 1 mode of free motion" in one.claim(system)
    assert ConewiseModeQuadratic.from_fields(THREE.to_fields(), system) == THREE
    for key in ("touching", "flying"):
        fields = THREE.to_fields()
        fields[key][1]["Q"]["denominator_log2"] = 1
        with pytest.raises(ValueError, match="do not share one denominator"):
            ConewiseModeQuadratic.from_fields(fields, system)
