"""Forms on a graph: known answers, what each condition bars, attacks, and what a shape covers.

Forgeries of small graphs are rows of test_graph.yaml.
"""

from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import comb

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.certificates.second_opinion import agrees
from nrs_design.proof.channels import Rounding
from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import Shows
from nrs_design.proof.evidence import graph as graph_module
from nrs_design.proof.evidence.abstract import NOT_ROUNDED
from nrs_design.proof.evidence.graph import ALL, Arc, FormsOnGraph, Multiplier, Node
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.steps import Stays
from nrs_design.proof.switching import Clock, Reset, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Verdict, certify
from nrs_design.search.method import Method
from tests.proof.graphs import (
    common_polynomial,
    common_quadratic,
    conewise_modes,
    in_turns,
    mode_quadratic,
    one_form,
    scalars,
)
from tests.proof.systems import (
    LAGGING,
    Entry,
    Rows,
    ando_shih,
    bouncing,
    bouncing_in_steps,
    bouncing_in_turns,
    crowded,
    family,
    genuine,
    losable,
    matrix,
    over,
    pushed,
    resets_between,
    shears,
)
from tests.proof.truth import edge_form, edges_at, holds, is_definite, is_in_other_units, moves
from tests.support import broken, ends_soon

HALF, STEPS = Fraction(1, 2), Time.DISCRETE
I2 = ((1, 0), (0, 1))
# Narendra and Balakrishnan 1994: x1^2 + x2^2 works for normal stable matrices.
COMMUTING = family([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])
# By hand: V = 4 v^2 + 4 v delta + 6 delta^2, and a function for the same mass in steps.
Q2, Q2_STEPS = ((4, 2), (2, 6)), ((40, 20), (20, 60))
SLOW, SLOW98 = Fraction(99, 100), Fraction(98, 100)


def conewise(system, Q, rate, crossings=(), roundings=(), log2=0) -> FormsOnGraph:
    lost = system.contact is not None
    numbers = {"crossings": crossings, "roundings": roundings}
    return one_form(system, Q, log2, Fraction(rate), **numbers, lost=lost)


BOUNCE = conewise(bouncing(), Q2, "1/5")
PULLED = conewise(bouncing(1), Q2, "1/5", (4, 4))
IN_STEPS = conewise(bouncing_in_steps(), Q2_STEPS, SLOW, (16,))
EACH = conewise_modes((("m0", Q2_STEPS), ("m1", Q2_STEPS)), (("free", ((40,),)),), 0, SLOW, (16,))


def by_mode(*forms, rate: Entry = "1/100") -> FormsOnGraph:
    return mode_quadratic(tuple((f"m{i}", Q) for i, Q in enumerate(forms)), 0, Fraction(rate))


def with_form(evidence: FormsOnGraph, k: int, form) -> FormsOnGraph:
    nodes = list(evidence.nodes)
    nodes[k] = Node(nodes[k].place, form)
    return replace(evidence, nodes=tuple(nodes))


class TestPolynomials:
    @pytest.mark.parametrize("example", ["common-polynomial", "mode-polynomial"])
    def test_forms_that_vanish(self, example):
        system, evidence = genuine(example)
        # With a large multiple of the identity the condition always holds.
        size = len(evidence.vanishing[0])
        large = tuple(tuple(10**30 * (i == j) for j in range(size)) for i in range(size))
        for k in range(len(evidence.vanishing)):
            forms = list(evidence.vanishing)
            forms[k] = large
            forged = replace(evidence, vanishing=tuple(forms))
            assert forged.find_fault(system) == "a form that must vanish does not"
            forms[k] = evidence.vanishing[k][:-1]
            forged = replace(evidence, vanishing=tuple(forms))
            assert forged.find_fault(system) == "a form that must vanish has the wrong size"
        for forms in (evidence.vanishing[:-1], (*evidence.vanishing, evidence.vanishing[-1]), ()):
            fault = replace(evidence, vanishing=forms).find_fault(system)
            assert fault == "there is not one vanishing form for each decrease"

    @pytest.mark.parametrize(("time", "bits"), [(Time.CONTINUOUS, 2 + 4), (STEPS, 2 + 4 * 4)])
    def test_the_longest_numbers(self, monkeypatch, time, bits):
        """Of Q, two bits, and of the modes, four: in discrete time for each of four factors."""
        Q, zero = (tuple(tuple(c * (i == j) for j in range(3)) for i in range(3)) for c in (3, 0))
        evidence = common_polynomial(2, Q, 0, (zero,), HALF)
        system = family([["-7/9", 0], [0, "-1/9"]], time=time)
        monkeypatch.setattr(graph_module, "MAX_WORK", 3**3 * bits)
        assert evidence.find_misfit(system) is None
        monkeypatch.setattr(graph_module, "MAX_WORK", 3**3 * bits - 1)
        assert evidence.find_misfit(system) == "its numbers are too large to check"

    def test_forms_of_one_state_by_hand(self):
        """``x' = -2/3 x`` and ``x+ = -2/3 x`` with ``V = 5 x^6``."""
        evidence = common_polynomial(3, ((5,),), 0, (((0,),),), HALF)
        system, a = family([["-2/3"]]), Fraction(2, 3)
        (_, Q), (_, ((form,),)) = evidence.forms(system)
        assert Q == ((5,),)
        assert form == 3 * 5 * 2 * 3 * (a - HALF)
        in_steps, rate = replace(system, time=STEPS), Fraction(3, 4)
        _, (_, ((form,),)) = replace(evidence, rate=rate).forms(in_steps)
        assert form == (3**3 * 4**3) ** 2 * 5 * (rate**6 - a**6)
        for one, best in ((system, HALF), (in_steps, rate)):
            assert replace(evidence, rate=best).find_fault(one) is None
            assert replace(evidence, rate=a).find_fault(one) is not None

    def test_contact_and_flight_share_their_polynomial(self):
        """Each is stable for itself, and bouncing grows."""
        system, evidence = genuine("conewise-polynomial")
        assert evidence.degree == 2
        other = with_form(
            evidence, 1, tuple(tuple(2 * e for e in row) for row in evidence.nodes[1].form)
        )
        assert "at the surface" in other.find_fault(system)
        assert not holds(system, other)


# Discrete families that grow, with functions that keep all conditions but one. Found by a random
# search; the growth is computed anew below.
ESCAPES = {
    "in mode m0": (over(8, (0, 0), (-10, 12)), over(8, (5, 0), (8, 8)), ((8, -6), (-6, 5))),
    "in free motion, mode f": (
        over(8, (-6, 2), (-5, 2)),
        over(8, (-9, 0), (-2, 8)),
        ((8, -5), (-5, 5)),
    ),
    "where contact is made, mode f": (
        over(8, (4, -7), (-3, -3)),
        over(8, (6, 0), (-8, 8)),
        ((8, -2), (-2, 9)),
    ),
    "where contact is lost in mode m0": (
        over(32, (88, 139, -63), (-47, -59, 56), (38, 57, -34)),
        over(32, (-9, -1, 0), (14, -7, 0), (-15, 0, 32)),
        ((9, 6, -13), (6, 15, 2), (-13, 2, 32)),
    ),
}


RISES = {
    "while the environment lags, mode f": (1, 5),
    "where a lagging environment is left, mode f": (-8, Fraction(19, 10)),
}


def in_two_turns(system: SwitchedSystem) -> SwitchedSystem:
    """Return the same motions at every step, under names of their own at the first of two."""
    first = tuple(replace(mode, name=f"{mode.name}, first") for mode in system.modes)
    free = tuple(replace(mode, name=f"{mode.name}, first") for mode in system.contact.free)
    names = tuple(mode.name for mode in (*first, *free))
    contact = replace(system.contact, free=(*free, *system.contact.free))
    return replace(system, modes=(*first, *system.modes), contact=contact, clock=Clock(2, names))


def growth(system: SwitchedSystem, Q: Rows, start: int) -> Fraction:
    """Return by how much V grows in 200 steps from some state, in fractions of bounded length."""
    x = [Fraction((7 * start + 3 * i * i + 1) % 11 - 5) for i in range(system.order)]
    before = _value(Q, x)
    touching, flying = system.modes[0].A.fractions(), system.contact.free[0].A.fractions()
    for _ in range(200):
        A = touching if x[-1] > 0 else flying
        x = [entry.limit_denominator(10**12) for entry in image(A, x)]
    return _value(Q, x) / before if before else Fraction(0)


def image(A: Rows, x: list[Fraction]) -> list[Fraction]:
    return [sum(a * b for a, b in zip(row, x, strict=True)) for row in A]


def quadratic(Q: Rows, x: list[Fraction]) -> Fraction:
    return sum(a * b for a, b in zip(x, image(Q, x), strict=True))


def _value(Q: Rows, x: list[Fraction]) -> Fraction:
    return quadratic(Q, [*x[:-1], max(x[-1], Fraction(0))])


class TestLostContact:
    @pytest.mark.parametrize(
        ("system", "evidence"),
        [
            (bouncing(), BOUNCE),
            (bouncing(1), PULLED),
            (bouncing_in_steps(), IN_STEPS),
            (bouncing_in_steps(), EACH),
        ],
    )
    def test_a_bouncing_mass_is_proved(self, system, evidence):
        assert agrees(system, evidence)
        assert evidence.shows is Shows.STABILITY
        claim = evidence.claim(system)
        assert "contact lost and made again at any time" in claim
        assert "2 modes in contact and 1 mode of free motion" in claim
        assert "as long as contact is kept" not in claim
        kept = common_quadratic(Q2, 0, Fraction(1, 5)).claim(replace(system, contact=None))
        assert "contact is kept" not in kept

    @pytest.mark.parametrize("where", ESCAPES)
    def test_each_condition_in_steps_bars_a_family_that_grows(self, where):
        contact, free, Q = ESCAPES[where]
        system = losable(contact, free, STEPS)
        whole = tuple(tuple(64 * entry for entry in row) for row in Q)
        faults = []
        for m in (0, 16, 32, 64, 128, 256, 512):
            candidate = conewise(system, whole, SLOW98, (m,))
            assert candidate.find_fault(system) is not None
            faults.append(broken(system, candidate))
        assert all(where in places for places in faults)
        # With some multiplier nothing else is broken.
        assert {where} in faults
        assert max(growth(system, Q, start) for start in range(40)) > 1000

    def test_landing_at_the_surface_is_a_condition_of_its_own(self):
        """A family that grows, with functions that keep all but that. Found by a random search."""
        contact = over(16, (-16, 13, 11), (-15, 8, 12), (-17, 6, 7))
        system = losable(contact, over(16, (-9, 4, 0), (13, 13, 0), (-14, 1, 16)), STEPS)
        whole = ((2195, -1026, -1348), (-1026, 876, 758), (-1348, 758, 988))
        flying = (("f", ((738, 184), (184, 554))),)
        candidate = conewise_modes((("m0", whole),), flying, 0, Fraction(995, 1000), (0,))
        assert broken(system, candidate) == {"where contact is made at the surface, mode f"}
        assert max(growth(system, whole, start) for start in range(40)) > 1000

    def test_steps_from_one_mode_to_another_are_conditions_of_their_own(self):
        """Each mode decreases its own function, and alternating grows: trace 4.5, all positive."""
        free = Contact((Mode("f", matrix([[0, 0], [0, 1]])),))
        pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
        system = replace(family(*pair, time=STEPS), contact=free)
        touching = ("m0", ((1, 0), (0, 100))), ("m1", ((100, 0), (0, 1)))
        candidate = conewise_modes(touching, (("f", ((1,),)),), 0, Fraction(9, 10), (0,))
        assert broken(system, candidate) == {"in mode m0", "in mode m1"}

    @pytest.mark.parametrize("where", LAGGING)
    def test_what_lags_in_steps_needs_its_own_conditions(self, where):
        """V rises from a state that lags although all else holds, whatever mu is."""
        (system, Q, multipliers), x = LAGGING[where], RISES[where]
        stays, rate = where.startswith("while"), Fraction(98, 100)
        for mu, beside in product((0, 1, 16, 64, 1024, 10**6), (0, 16, 256, 10**5)):
            first, second, *rest = multipliers
            tried = (first, mu, *rest) if stays else (first, second, mu, beside)
            fault = conewise(system, Q, rate, tried).find_fault(system)
            assert fault == f"V does not decrease at the claimed rate {where}"
        sprung = replace(system, contact=Contact(system.contact.free))
        assert conewise(sprung, Q, rate, multipliers[:1]).find_fault(sprung) is None
        x = [Fraction(entry) for entry in x]
        (pull,), (free,) = (q.fractions()[0] for q in system.contact.pulls), system.contact.free
        after = image(free.A.fractions(), x)
        assert image([pull], x)[0] < 0 < x[-1]
        assert (after[-1] > 0) is stays
        assert _value(Q, after) > _value(Q, x)

    def test_an_environment_that_lags_needs_its_own_condition(self):
        """With a force that vanishes while the mass moves in, V rises at (v, delta) = (1, 10)."""
        motions = [[-2, -2], [1, 0]], [[-2, 0], [1, 0]]
        system = losable(*motions, Time.CONTINUOUS, [[-20, 1]])
        for multiplier in (0, 1, 10, 100):
            fault = conewise(system, Q2, "1/5", (multiplier,)).find_fault(system)
            assert "while the environment lags, mode f" in fault
        v, delta = Fraction(1), Fraction(10)
        assert -20 * v + delta < 0 < (4 * v + 2 * delta) * (-2 * v) + (2 * v + 6 * delta) * v
        assert BOUNCE.find_fault(losable(*motions, Time.CONTINUOUS)) is None

    def test_combinations_of_modes_decrease_the_largest_form(self):
        """A stiffness between its ends, landing at any depth."""
        system, evidence = genuine("conewise-mode-quadratic")
        ends = [mode.A.fractions() for mode in system.modes]
        free = system.contact.free[0].A.fractions()
        touching = [form for place, form in evidence.nodes if place == "modes"]
        (flying,) = [form for place, form in evidence.nodes if place == "free"]

        def V(x, forms):
            return max(quadratic(Q, x) for Q in forms)

        shares = [Fraction(k, 4) for k in range(5)]
        for share, depth, v in product(shares, shares, (-3, -1, 0, 2)):
            x = [Fraction(v), Fraction(1)]
            A = [
                [(1 - share) * a + share * b for a, b in zip(*rows, strict=True)]
                for rows in zip(*ends, strict=True)
            ]
            moved = image(A, x)
            value = V(moved, touching) if moved[1] > 0 else V(moved[:1], [flying])
            assert value < evidence.rate**2 * V(x, touching)
            flown = [free[0][0] * v, max(free[1][0] * v, Fraction(0)) * depth]
            if v:
                assert V(flown, touching) < evidence.rate**2 * V([Fraction(v)], [flying])


class TestAgainstTheDefinition:
    """Random systems and numbers; the definition in fractions, decided by another elimination."""

    @settings(deadline=None)
    @given(
        st.lists(st.integers(-8, 8), min_size=8, max_size=8),
        st.tuples(*[st.integers(-8, 8)] * 4),
        st.lists(st.integers(-6, 9), min_size=6, max_size=6),
        st.lists(st.integers(0, 6), min_size=8, max_size=8),
        st.fractions("1/10", 2),
        st.sampled_from(["flow", "steps", "each", "turns"]),
        st.booleans(),
    )
    def test_lost_contact(self, contact, free, Q, multipliers, rate, shape, pulled):
        a, b, c, d, e, f, g, h = (Fraction(entry, 8) for entry in contact)
        p, q, r, s = (Fraction(entry, 8) for entry in free)
        flows = shape == "flow"
        last = int(not flows)
        motions = (Mode("f0", matrix([[p, 0], [q, last]])), Mode("f1", matrix([[r, 0], [s, last]])))
        pulls = (matrix([["1/3", "2/3"]]),) if pulled and shape != "each" else ()
        system = replace(
            family([[a, b], [c, d]], [[e, f], [g, h]], time=Time.CONTINUOUS if flows else STEPS),
            contact=Contact(motions, pulls),
            clock=Clock(2, ("m0", "f0")) if shape == "turns" else None,
        )
        x, y, z, u, v, w = Q
        count = (2 if flows else 4) if pulls else (0 if flows else 1)
        forms = ((x, y), (y, z)), ((u, v), (v, w))
        if shape == "turns":
            own = tuple(multipliers[:count]), tuple(multipliers[4 : 4 + count])
            candidate = in_turns(system, forms, 0, rate, own)
        elif shape == "each":
            flying = ("f0", ((x,),)), ("f1", ((u,),))
            named = zip(("m0", "m1"), forms, strict=True)
            candidate = conewise_modes(tuple(named), flying, 0, rate, multipliers[:2])
        else:
            candidate = conewise(system, forms[0], rate, tuple(multipliers[:count]))
        assert (candidate.find_fault(system) is None) == holds(system, candidate)


class TestTurns:
    def test_what_is_not_rounded_is_said(self):
        system, evidence = genuine("periodic-quadratic, rounding")
        kept = tuple(m for m in evidence.multipliers if not m.fact.startswith("rounding"))
        exact = replace(evidence, multipliers=kept)
        assert exact.find_fault(system) is None
        assert NOT_ROUNDED in exact.claim(system)


class TestStays:
    def by_modes(self, system):
        return certify(system, Method.MODE_QUADRATIC)

    @pytest.mark.parametrize(
        "rules", [Switching(Fraction(50)), Switching(transitions=()), Switching()]
    )
    def test_the_ends_of_a_constant_parameter_prove_nothing_in_between(self, rules):
        # Both ends are Hurwitz; halfway, [[-1, 5], [5, -1]] has the eigenvalue 4.
        system = shears(replace(rules, fixed_ends=(("m0", "m1"),)))
        found = self.by_modes(shears(rules)).evidence
        assert found is None or "kind of switching" in found.find_fault(system)

    @pytest.mark.parametrize("exponent", [3, 12, 300])
    def test_stiff_modes_neither_hang_nor_crash(self, exponent):
        fast, rules = 10**exponent, Switching(Fraction(1))
        system = family([[-fast, 0], [0, -1]], [[-1, 0], [0, -fast]], switching=rules)
        with ends_soon():
            assert by_mode(I2, I2).find_fault(system) is None

    def test_numbers_at_a_switch_may_be_too_large(self):
        numbers = tuple(tuple(int(i == j) for j in range(20)) for i in range(20))
        tiny = RationalMatrix(numbers, 2**7000)
        A = [[-int(i == j) for j in range(20)] for i in range(20)]
        large = family(A, A, switching=Switching(resets=(Reset("m0", "m1", tiny),)))
        fault = "the numbers at the switch from m0 to m1 are too large to check"
        assert by_mode(numbers, numbers, rate="1/2").find_fault(large) == fault


# x+ = A x for one of two modes; alternately they halve x, and each alone doubles it.
DRAWN = family([["1/2"]], [["1/2"]], time=STEPS)


def at(place: str, count: int) -> tuple[Node, ...]:
    return (Node(place, ((1,),)),) * count


def _with_many_forces() -> SwitchedSystem:
    free = tuple(Mode(f"f{k}", matrix([[0, 0], [0, 1]])) for k in range(3000))
    return replace(bouncing_in_steps(), contact=Contact(free, (matrix([[1, 1]]),) * 3000))


HALVED, EDGES = family([["1/2"]], time=STEPS), "there are too many edges to check"
HOSTILE = {
    "nodes": (HALVED, FormsOnGraph(at("modes", 99_999), 0, SLOW), EDGES),
    "edges": (
        HALVED,
        FormsOnGraph(at("modes", 99), 0, SLOW, edges=tuple(Arc(0, "", k) for k in range(99_999))),
        "the graph has no edge in mode m0",
    ),
    "nodes of modes": (
        DRAWN,
        FormsOnGraph((*at("m0", 3000), *at("m1", 3000)), 0, SLOW, stays=Stays()),
        EDGES,
    ),
    "multipliers": (
        bouncing_in_steps(),
        FormsOnGraph(
            ((Node("modes", Q2_STEPS),) * 999 + at("free", 999)),
            0,
            SLOW,
            multipliers=tuple(Multiplier("lost", 1, k) for k in range(1998)),
        ),
        EDGES,
    ),
    "forces": (_with_many_forces(), IN_STEPS, EDGES),
    "modes": (
        family(*[[[0]]] * 5000, time=STEPS, switching=Switching(transitions=())),
        scalars(*[1] * 5000),
        "there are too many switches to check",
    ),
}


class TestGraph:
    """Edges that are chosen, the words that they leave out, and what a shape covers."""

    def test_forms_that_remember_the_last_mode(self):
        """Of Ando and Shih's pair, the norm of what a mode leaves: no common form does it."""
        system = ando_shih("0.99")
        # After m0 both states are equal, after m1 opposite: c (1, 1) x1 or c (1, -1) x2.
        nodes = tuple(
            Node("modes", form) for form in (((51, 49), (49, 51)), ((51, -49), (-49, 51)))
        )
        drawn = FormsOnGraph(nodes, 0, Fraction(999, 1000))
        memory = (Arc(None, "m0", 0), Arc(None, "m1", 1))
        remembering = replace(drawn, edges=memory)
        assert remembering.edges != ALL
        fault = remembering.find_fault(system)
        assert (fault is None) == holds(system, remembering)
        assert not remembering.bounds_at_once
        assert not remembering.covers_mixtures
        assert "some constant c" in remembering.claim(system)
        # A word that ends in m0 has no edge for m1 if m1 only follows itself.
        narrow = replace(remembering, edges=(Arc(None, "m0", 0), Arc(1, "m1", 1)))
        assert narrow.find_fault(DRAWN) is not None

    def test_too_many_edges_are_refused(self, monkeypatch):
        monkeypatch.setattr(graph_module, "MAX_WORK", 1)
        graph = common_quadratic(((1,),), 0, Fraction(9, 10))
        assert graph.find_misfit(DRAWN) == "there are too many edges to check"

    def test_averages_grow_where_each_mode_has_a_multiplier_of_its_own(self):
        """By way of targets: ``x+ = C r``, ``|r| <= q |x|``, each C q is a half, of means 25."""
        columns, rows = (matrix([[10]]), matrix([["1/20"]])), (matrix([["1/20"]]), matrix([[10]]))
        system = family([[0]], [[0]], time=STEPS)
        rounded = replace(system, roundings=(Rounding("r", columns, rows),))
        nodes, edges = (Node("modes", ((1024,),)),) * 2, (Arc(None, "m0", 0), Arc(None, "m1", 1))
        own = (Multiplier("rounding 1", 110 * 1024, 0), Multiplier("rounding 1", 5, 1))
        graph = FormsOnGraph(nodes, 10, SLOW, multipliers=own, edges=edges)
        refused = "edges lead to all nodes of a place where contact is lost or arithmetic rounds"
        assert broken(rounded, graph) == set()
        assert graph.find_misfit(rounded) == refused
        # Without rounding they are linear, and an average for ever is no worse than words of modes;
        # but that is not what a graph proves.
        linear = replace(graph, multipliers=())
        assert linear.find_fault(system) is None
        constant = replace(system, switching=Switching(fixed_ends=(("m0", "m1"),)))
        assert "this kind of switching" in linear.find_fault(constant)
        assert replace(linear, edges=ALL).find_fault(constant) is None

    @pytest.mark.parametrize("case", HOSTILE)
    def test_what_nobody_can_check_is_refused_at_once(self, case):
        system, graph, fault = HOSTILE[case]
        with ends_soon():
            assert graph.find_fault(system) == fault

    def test_sets_of_nodes_are_followed_only_so_far(self, monkeypatch):
        """A chain of sets, each with a node less."""
        edges = (
            Arc(59, "m0", 59),
            *(Arc(k, "m0", k + 1) for k in range(59)),
            Arc(None, "m1", None),
        )
        graph = FormsOnGraph(at("modes", 60), 0, SLOW, edges=edges)
        assert graph.find_fault(DRAWN) is None
        # Its edges are few enough.
        monkeypatch.setattr(graph_module, "LEAST_WORK", 10**4)
        assert graph.find_misfit(DRAWN) == "the graph has too many sets of nodes"


class TestFields:
    def test_only_what_is_not_usual_is_written(self):
        evidence = common_quadratic(I2, 0, HALF)
        fields = evidence.to_fields()
        nodes = [{"place": "modes", "form": [[1, 0], [0, 1]]}]
        assert fields == {"nodes": nodes, "denominator_log2": 0, "rate": "1/2"}
        assert FormsOnGraph.from_fields(fields, COMMUTING) == evidence

    def test_nothing_follows_from_no_form(self):
        with pytest.raises(ValueError, match="it has no form"):
            FormsOnGraph.from_fields({"nodes": [], "denominator_log2": 0, "rate": "1/2"}, COMMUTING)


# Each condition is needed: families that grow although all conditions but one hold.
LEAP = Switching(resets=resets_between(("m0", "m1", [[8]])))
LEAPING = family([["1/2"]], [["1/2"]], time=STEPS, switching=LEAP)
ZERO = ((0,),)


def quartic(*values: int) -> FormsOnGraph:
    return replace(scalars(*values, rate="3/4"), degree=2, vanishing=(ZERO,) * len(values) ** 2)


@pytest.mark.parametrize(
    ("system", "evidence", "words"),
    [
        (family([[1]]), common_quadratic(((-1,),), 0, HALF), "positive definite"),
        (family([[-1]], [[1]]), common_quadratic(((1,),), 0, HALF), "in mode m1"),
        (family([["1/4"]], [[2]], time=STEPS), common_quadratic(((1,),), 0, HALF), "in mode m1"),
        (family([[1]]), common_polynomial(2, ((-1,),), 0, (ZERO,), HALF), "positive definite"),
        (family([[-1]], [[1]]), common_polynomial(2, ((1,),), 0, (ZERO,) * 2, HALF), "in mode m1"),
        (family([[2]], time=STEPS), scalars(-1, rate="3/4"), "positive definite"),
        (LEAPING, scalars(1, 1, rate="3/4"), "from m0 to m1"),
        (family([[2]], time=STEPS), quartic(-1), "positive definite"),
        (LEAPING, quartic(1, 1), "from m0 to m1"),
    ],
)
def test_one_condition_fails_and_the_family_grows(system, evidence, words):
    assert evidence.find_misfit(system) is None
    failing = [why for why, form in evidence.forms(system) if not is_definite(form)]
    assert len(failing) == 1
    assert words in failing[0]
    assert failing[0] in evidence.find_fault(system)
    assert certify(system).verdict is Verdict.REFUTED


def test_turns_in_steps_have_the_forms_of_one_for_all():
    for system in (bouncing_in_steps(), bouncing_in_steps(1)):
        crossings = (16, 3, 5, 7, 3, 5, 7)[: 1 + 3 * len(system.contact.pulls)]
        one = conewise(system, Q2_STEPS, SLOW, crossings)
        twice = in_turns(system, (Q2_STEPS,) * 2, 0, SLOW, (crossings,) * 2)
        forms = {str(form) for _, form in one.forms(system)}
        assert forms == {str(form) for _, form in twice.forms(in_two_turns(system))}


FORMS3 = ((9, 2, -1), (2, 7, 3), (-1, 3, 8)), ((6, 1, 2), (1, 5, -2), (2, -2, 7))


MULTIPLIERS3 = {
    Time.CONTINUOUS: ("pull 1 f0", "pull 2 f0", "pull 1 f1", "pull 2 f1"),
    STEPS: ("lost", *(f"{p}" for k in (1, 2) for p in (f"pull {k}", f"pull {k} lost",
            f"lost pull {k}")), "rounding 1", "rounding 2"),
}  # fmt: skip


@pytest.mark.parametrize("shape", [Time.CONTINUOUS, STEPS, "each"])
def test_every_form_by_hand(shape):
    """Lost contact with what lags, and what is rounded; or a form for each mode."""
    if shape == "each":
        system = replace(crowded(STEPS, pulled=False), roundings=())
        flying = ("f0", ((4, 1), (1, 3))), ("f1", ((5, -2), (-2, 6)))
        named = tuple(zip(("m0", "m1"), FORMS3, strict=True))
        evidence = conewise_modes(named, flying, 0, Fraction(6, 7), (5, 3))
    else:
        system, lost = crowded(shape), FORMS3[0]
        facts = zip(MULTIPLIERS3[shape], (3, 5, 7, 11, 13, 17, 19, 23, 29), strict=False)
        nodes = Node("modes", lost), Node("free", tuple(row[:2] for row in lost[:2]))
        numbers = tuple(Multiplier(fact, value) for fact, value in facts)
        evidence = FormsOnGraph(nodes, 0, Fraction(2, 7), multipliers=numbers)
    assert evidence.find_misfit(system) is None
    rounding = bool(system.roundings)
    steps = [move for move in moves(system, lost=True, rounding=rounding) if move.strict]
    wanted = [
        (steps[k].where, edge_form(evidence, steps[k], a, b))
        for k, a, b in edges_at(evidence, steps)
    ]
    words, forms = zip(*evidence.forms(system), strict=True)
    count = len(evidence.nodes)
    assert forms[:count] == tuple(node.form for node in evidence.nodes)
    found = [word.partition("rate ")[2] for word in words[count:]]
    assert found == [where for where, _ in wanted]
    for form, (where, true) in zip(forms[count:], wanted, strict=True):
        assert is_in_other_units(form, true), where


@pytest.mark.parametrize("degree", [1, 3])
def test_forms_between_modes_of_one_state_by_hand(degree):
    """``5 x^2d`` and ``7 x^2d`` at the rate 3/4; the switch to m1 multiplies by two fifths."""
    rules = Switching(resets=resets_between(("m0", "m1", [["2/5"]])))
    system = family([["1/2"]], [["-1/3"]], time=STEPS, switching=rules)
    zero = (((0,),),) * 4 if degree > 1 else ()
    evidence = replace(scalars(5, 7, rate="3/4"), degree=degree, vanishing=zero)
    first, second, *forms = (form for _, form in evidence.forms(system))
    assert (first, second) == (((5,),), ((7,),))
    kept, power = Fraction(3, 4) ** (2 * degree), 2 * degree
    maps = ((5, 5, "1/2"), (7, 7, "1/3"), (5, 7, "1/5"), (7, 5, "1/3"))
    for ((form,),), (before, after, gain) in zip(forms, maps, strict=True):
        true = kept * before - after * Fraction(gain) ** power
        unit = (4 * Fraction(gain).denominator) ** power
        assert Fraction(form) / true in (unit, Fraction(unit, 3**power), unit // 2**power)


SHAPES = {
    "one": (bouncing_in_steps(), IN_STEPS),
    "flow": (bouncing(1), PULLED),
    "each": (bouncing_in_steps(), EACH),
    "turns": (bouncing_in_turns(), in_turns(bouncing_in_turns(), (Q2_STEPS,) * 2, 0, SLOW,
                                            ((16,), (16,)))),
    "stays": (family([["1/2", 0], [0, "1/2"]], [["1/4", 0], [0, "1/4"]], time=STEPS),
              by_mode(I2, I2, rate="3/4")),
}  # fmt: skip


class TestRefused:
    """Numbers that do not fit, of every shape; and sizes that would take hours."""

    @pytest.mark.parametrize("shape", SHAPES)
    def test_numbers_that_do_not_fit(self, shape):
        system, evidence = SHAPES[shape]
        assert evidence.find_misfit(system) is None
        for k, (place, form) in enumerate(evidence.nodes):
            n = len(form)
            wide = tuple((*row, 0) for row in form)
            for other in ((), wide, form[:-1], ((1,) * (n + 1),) * (n + 1)):
                fault = f"a form at {place}: Q is not a {n} x {n} matrix"
                assert with_form(evidence, k, other).find_fault(system) == fault
            skew = (*form[:-1], (form[-1][0] + 1, *form[-1][1:]))
            negative = tuple(tuple(-e for e in row) for row in form)
            # A form of one state is always symmetric.
            for other in (negative, *[skew] * (n > 1)):
                assert with_form(evidence, k, other).find_fault(system) is not None
                assert not holds(system, with_form(evidence, k, other))
        for rate in (Fraction(0), Fraction(-1, 2), *[Fraction(1)] * (system.time is STEPS)):
            fault = replace(evidence, rate=rate).find_fault(system)
            assert fault == "the claimed rate is not one of exponential decay"
        names = {node.place for node in evidence.nodes}
        for name in names:
            nodes = tuple(node for node in evidence.nodes if node.place != name)
            # Without forms in flight it would be one of kept contact, which nothing is lost in.
            fault = replace(evidence, nodes=nodes).find_fault(system)
            assert ("no fact" if name == "free" else "every place") in fault
        for k, item in enumerate(evidence.multipliers):
            changed = [*evidence.multipliers]
            changed[k] = item._replace(value=-1)
            fault = replace(evidence, multipliers=tuple(changed)).find_fault(system)
            assert fault == "a multiplier is negative"
        for fact in ("rounding 1", "coupling 1", "lost 1", "pull 3"):
            odd = replace(evidence, multipliers=(*evidence.multipliers, Multiplier(fact, 1)))
            assert "multiplier" in odd.find_fault(system)
        idle = tuple(item._replace(value=0) for item in evidence.multipliers)
        assert replace(evidence, multipliers=idle).find_misfit(system) is None

    def test_no_crossings_where_contact_is_kept(self):
        kept = replace(bouncing_in_turns(), contact=None, clock=Clock(2, ("push 1", "push 2")))
        alone = in_turns(kept, (Q2_STEPS,) * 2, 0, SLOW)
        assert alone.find_misfit(kept) is None
        lost = replace(alone, multipliers=(Multiplier("lost", 16),))
        assert "no fact" in lost.find_misfit(kept)

    @pytest.mark.parametrize(("n", "degree"), [(120, 1), (121, 1), (3, 14), (64, 2), (64, 32)])
    def test_the_most_monomials(self, n, degree):
        """There are 120 of degree 14 in three variables; quadratic forms have as many states."""
        size = comb(n + degree - 1, degree)
        large = size > 120
        unit, zero = (
            tuple(tuple(c * (i == j) for j in range(1 if large and degree > 1 else size))
                  for i in range(1 if large and degree > 1 else size)) for c in (1, 0)
        )  # fmt: skip
        evidence = common_polynomial(degree, unit, 0, (zero,) if degree > 1 else (), HALF)
        system = family([[-int(i == j) for j in range(n)] for i in range(n)])
        refused = large and degree > 1
        fault = f"there are more than 120 monomials of degree {degree}" if refused else None
        with ends_soon():
            assert evidence.find_misfit(system) == fault

    @pytest.mark.parametrize(
        ("modes", "resets", "bits"),
        [((7, 1), (), 3), (("1/5", 1), (), 3), ((1, -7), (), 3), ((1, 1), (5,), 3),
         ((1, 1), ("1/7",), 3), ((1, 1), ("1/9",), 4)],
    )  # fmt: skip
    def test_the_longest_numbers_that_are_lifted(self, monkeypatch, modes, resets, bits):
        """Of modes and of resets, numerators and denominators: the longest, for four factors."""
        rules = Switching(resets=resets_between(*(("m0", "m1", [[g]]) for g in resets)))
        system = family(*([[entry]] for entry in modes), time=STEPS, switching=rules)
        evidence = quartic(1, 1)
        monkeypatch.setattr(graph_module, "LEAST_WORK", 0)
        monkeypatch.setattr(graph_module, "MAX_WORK", 1 + 4 * bits)
        assert evidence.find_misfit(system) is None
        monkeypatch.setattr(graph_module, "MAX_WORK", 4 * bits)
        assert evidence.find_misfit(system) == "its numbers are too large to check"

    def test_long_powers_that_are_lifted_do_not_hang(self):
        """A stay of 4096 steps, in 36 monomials of degree 7."""
        A = [[Fraction(i + 2 * j + 1, 10**9 + 7) for j in range(3)] for i in range(3)]
        unit, zero = (
            tuple(tuple(c * (i == j) for j in range(36)) for i in range(36)) for c in (1, 0)
        )
        system = family(A, A, time=STEPS, switching=Switching(Fraction(4096)))
        item = replace(by_mode(unit, unit, rate="9/10"), degree=7, vanishing=(zero,) * 4)
        with ends_soon():
            fault = item.find_fault(system)
        assert fault == "the dwell time is too long for such large numbers"


class TestAttacks:
    def test_a_form_in_flight_that_does_not_vanish_proves_nothing(self):
        """It would make any decrease positive: here that of a mass that does not slow down."""
        sliding = losable([[-2, -1], [1, 0]], [[0, 0], [1, 0]], Time.CONTINUOUS)
        _, evidence = genuine("conewise-polynomial")
        forged = replace(evidence, vanishing=(*evidence.vanishing[:1], ((10**9,),)))
        assert broken(sliding, forged) == set()
        assert forged.find_fault(sliding) == "a form that must vanish does not"
        honest = replace(forged, vanishing=(*evidence.vanishing[:1], ((0,),)))
        assert "in free motion, mode f" in honest.find_fault(sliding)

    def test_what_disturbs_is_not_taken_for_a_rounding(self):
        """Rows of roundings go over the state and what disturbs it, which decay says nothing of."""
        system = bouncing_in_turns(rounded=True)
        (item,) = system.roundings
        numbers = ((16,), (16,)), ((1,), (1,))
        evidence = in_turns(system, (Q2_STEPS,) * 2, 0, SLOW, *numbers)

        def disturbed(first: int) -> SwitchedSystem:
            rows = (row.fractions()[0] for row in item.rows)
            wide = tuple(matrix([[first or row[0], *row[1:], 7]]) for row in rows)
            return pushed(replace(system, roundings=(replace(item, rows=wide),)))

        assert [*evidence.forms(disturbed(0))] == [*evidence.forms(system)]
        # A rounding that grows with the state is still held against.
        assert evidence.find_fault(disturbed(100)) is not None


class TestRulesOfStays:
    """What rules of switching ask for besides, and sizes that do not hang."""

    @pytest.mark.parametrize("dwell", [4096, 4097, 10**30])
    def test_hostile_dwell_times_rates_and_sizes_do_not_hang(self, dwell):
        n, rules = 64, Switching(Fraction(dwell))
        A = [[Fraction((i * j) % 5 - 2 - 900 * (i == j), 1000) for j in range(n)] for i in range(n)]
        unit = tuple(tuple(int(i == j) for j in range(n)) for i in range(n))
        large = family(A, A, time=STEPS, switching=rules)
        small = family([["1/2"]], [["1/3"]], time=STEPS, switching=rules)
        with ends_soon():
            assert by_mode(unit, unit, rate="999/1000").find_fault(large) is not None
            long_rate = Fraction(10**1999 - 1, 10**1999)
            assert scalars(1, 1, rate=long_rate).find_fault(small) is not None
