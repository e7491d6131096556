"""All modes of a design in one state, and what is said about them."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import product
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers import laws
from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.errors import AssemblyError
from nrs_design.loop.close_loop import close_loop
from nrs_design.loop.modes import velocity_mode
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.contact import Elastic, KelvinBoltzmann, KelvinVoigt, Maxwell
from nrs_design.models.contact.environment import Environment, touch_at_once
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import combine
from nrs_design.models.plant import Plant
from nrs_design.spec.build_plant import build_conditions
from tests.loop.support import LOOP, MOTION, loaded, objects, polynomial, positive, stable
from tests.support import SOFT_TISSUE, words_of

F = Fraction
MOTOR = ActuatorRanges(Interval.point(F(1)), Interval.point(F(1)), "rpm")
CONDITIONS = build_conditions(loaded(SOFT_TISSUE).spec)


def closed(environments, *controllers, contact=None):
    """Close the motion loop of the thesis around some environments."""
    plant = Plant(tuple(environments), MOTOR, LOOP)
    design = ControllerDesign(laws.ProportionalDerivative(F(1), F(1)), controllers)
    return close_loop(replace(CONDITIONS, contact=contact), plant, design)[0]


def impedance(name, Mt, contacts=("soft",)):
    return Controller(name, laws.Admittance(F(Mt), F(2)), contacts[0], contacts)


def assembled(*controllers, contact=None):
    soft = Environment("soft", Elastic, (Interval(F(43), F(41), F(45)),))
    hand = Environment(
        "hand", KelvinVoigt, (Interval(F(50), F(25), F(90)), Interval(F(1), F(0), F(2)))
    )
    return closed((soft, hand), *controllers, contact=contact)


@dataclass(frozen=True, slots=True)
class Lagged(laws.AbstractCompliantLaw):
    """A law with one state, as an admittance with inertia has one."""

    name = "lagged"
    units = MappingProxyType({"K": "rad/(N*m*s)"})
    commands = "velocity"

    K: Fraction

    @property
    def states(self):
        return ("lag [rad/s]",)

    def respond(self, force, states):
        return states[0], [combine((-self.K, force), (F(-1), states[0]))]

    def discretize(self, period, method):
        raise NotImplementedError


POSITION = Controller("p", laws.PositionControl(), None, ())


class TestAssembly:
    def test_one_mode_for_each_corner(self):
        system = assembled(impedance("in", "0.01", ("soft", "hand")), impedance("out", "0.1"))
        corners = [f"in/hand/k-{k}/b-{b}" for k, b in product(("min", "max"), repeat=2)]
        names = ["in/soft/k-min", "in/soft/k-max", *corners, "out/soft/k-min", "out/soft/k-max"]
        assert [mode.name for mode in system.modes] == names
        assert system.states == ("xp1", "xp2", "vm [rad/s]", "delta [rad]")
        assert all(mode.A.shape == (4, 4) for mode in system.modes)

    def test_names_of_states(self):
        assert assembled(impedance("a", 0)).states == ("xp1", "xp2", "delta [rad]")
        position = assembled(POSITION)
        assert position.states == ("xp1", "xp2")
        assert position.modes[0].A.fractions() == [list(row) for row in MOTION.A]

    def test_with_a_spring_free_motion_is_a_mode_like_others(self):
        sprung = Controller("in", laws.Admittance(F("0.01"), F(2), F("0.5")), "soft", ("soft",))
        system = assembled(sprung, contact="losable")
        assert [mode.name for mode in system.modes] == ["in/soft/k-min", "in/soft/k-max", "in/free"]
        assert system.contact is None
        assert all(stable(mode.A.fractions()) for mode in system.modes)
        for contact in (None, "kept"):
            assert len(assembled(sprung, contact=contact).modes) == 2
        plain = impedance("out", "0.01")
        with pytest.raises(AssemblyError, match="some controllers have a spring Kt"):
            assembled(sprung, plain, contact="losable")

    def test_a_spring_needs_a_deflection_that_stays(self):
        sprung = laws.Admittance(F("0.01"), F(2), F("0.5"))
        with pytest.raises(AssemblyError, match="gel, which has no rest position") as caught:
            viscoelastic("gel", law=sprung)
        assert caught.value.at == ("controllers", "in", "Kt")

    def test_mixed_inertia(self):
        with pytest.raises(AssemblyError, match="different states of their own") as caught:
            assembled(impedance("a", 0), impedance("b", 1))
        assert "(impedance with no state; impedance with vm [rad/s])" in caught.value.message
        assert "none of them" in caught.value.remedy

    def test_states_are_shared_by_name_and_not_by_number(self):
        """As many states, but others: the matrices would fit, and mean nothing together."""
        lagged = Controller("b", Lagged(F(1)), "soft", ("soft",))
        assert assembled(lagged).states == ("xp1", "xp2", "lag [rad/s]", "delta [rad]")
        with pytest.raises(AssemblyError, match="different states of their own"):
            assembled(impedance("a", 1), lagged)


# Thesis table 2.4, the nose: k1, k2, b and, with a name of its own, Maxwell's k, b.
NOSE = KelvinBoltzmann(F("0.233"), F("0.972"), F("23.631"))
GEL = Maxwell(F("1.129"), F("120.233"))
RANGES = tuple(
    Interval(value, value * F(8, 10), value * F(12, 10)) for value in (*NOSE.exact, *GEL.exact)
)
ENVIRONMENTS = {
    "nose": Environment("nose", KelvinBoltzmann, RANGES[:3]),
    "concha": Environment(
        "concha", KelvinBoltzmann, tuple(map(Interval.point, map(F, (1, 3, 30))))
    ),
    "gel": Environment("gel", Maxwell, RANGES[3:]),
    "tool": Environment("tool", Elastic, (Interval(F(43), F(41), F(45)),)),
}


@cache
def viscoelastic(*contacts, Mt="0.01", law=None):
    law = law or laws.Admittance(F(Mt), F(2))
    return closed(ENVIRONMENTS.values(), Controller("in", law, contacts[0], contacts))


def product_of(*polynomials):
    found = objects(F(1))
    for factor in polynomials:
        found = np.convolve(found, objects(*factor))
    return found


class TestViscoelastic:
    @given(k1=positive, k2=positive, b=positive, Mt=positive, Bt=positive, massless=st.booleans())
    def test_characteristic_polynomial_is_that_of_the_loop(self, k1, k2, b, Mt, Bt, massless):
        """``den G den Ze / Y + num G num Ze`` with the impedances of thesis 2.5, written out."""
        Mt = F(0) if massless else Mt
        for law, above, below in (
            (KelvinBoltzmann(k1, k2, b), (b * k2, k1 * k2), (b, k1 + k2, F(0))),
            (Maxwell(k2, b), (k2 * b,), (b, k2)),
        ):
            admittance = (Bt,) if massless else (Mt, Bt)
            free = product_of(LOOP.denominator, below, admittance)
            contact = product_of(LOOP.numerator, above)
            free[len(free) - len(contact) :] += contact
            found = polynomial(velocity_mode(MOTION, laws.Admittance(Mt, Bt), law))
            assert list(free / free[0]) == found

    def test_maxwell_has_no_deflection_among_its_states(self):
        """With it the loop had an eigenvalue zero: it creeps, and nothing drives it back."""
        rows = velocity_mode(MOTION, laws.Admittance(F("0.01"), F(2)), GEL)
        assert stable(rows)
        with_delta = [[*row, F(0)] for row in rows] + [[*MOTION.C, F(0), F(0), F(0)]]
        assert polynomial(with_delta) == [*polynomial(rows), 0]

    def test_corners_of_every_parameter(self):
        system = viscoelastic("nose")
        assert len(system.modes) == 8
        assert system.modes[0].name == "in/nose/k1-min/k2-min/b-min"
        assert system.states[3:] == ("delta [rad]", "nose: damper deflection [rad]")
        assert viscoelastic("nose", Mt="0").states[2:] == system.states[3:]
        gel = viscoelastic("gel")
        assert len(gel.modes) == 4
        assert gel.states == ("xp1", "xp2", "vm [rad/s]", "spring stretch [rad]")

    def test_what_is_not_touched_creeps_back_alone(self):
        system = viscoelastic("nose", "tool", "concha")
        assert system.states[4:] == (
            "nose: damper deflection [rad]",
            "concha: damper deflection [rad]",
        )
        tool = next(m for m in system.modes if m.name == "in/tool/k-min/r-nose-max").A.fractions()
        # k1/b of the nose at most, and of the concha.
        assert tool[4] == [0, 0, 0, 0, -F("0.233") / F("23.631") * F(12, 8), 0]
        assert tool[5] == [0, 0, 0, 0, 0, F(-1, 30)]
        assert [row[4:] for row in tool[:4]] == [[0, 0]] * 4
        plain = velocity_mode(MOTION, laws.Admittance(F("0.01"), F(2)), Elastic(F(41)))
        assert [row[:4] for row in tool[:4]] == plain
        concha = next(m for m in system.modes if m.name == "in/concha/r-nose-min").A.fractions()
        assert concha[4] == [0, 0, 0, 0, -F("0.233") / F("23.631") * F(8, 12), 0]
        assert concha[5] == [0, 0, 0, F(3, 30), 0, F(-4, 30)]

    def test_assumptions(self):
        alone = " ".join(words_of(viscoelastic("nose")))
        assert "The damper of nose keeps its deflection at a switch" in alone
        assert "creeps back" not in alone
        both = " ".join(words_of(viscoelastic("nose", "tool")))
        assert "While another environment is touched, nose is free of force" in both
        gel = " ".join(words_of(viscoelastic("gel")))
        assert "that the deflection itself returns to zero is not claimed" in gel
        assert "nor that it stays bounded under a command" in gel
        assert "The deflection is continuous" not in gel

    def test_what_has_no_rest_position_is_touched_alone_and_by_velocities(self):
        with pytest.raises(AssemblyError, match="gel has no rest position"):
            viscoelastic("tool", "gel")
        with pytest.raises(AssemblyError, match="from which positions"):
            viscoelastic("gel", law=laws.ProportionalForce(F("0.02")))


def test_things_touched_at_once():
    """Springs may be lost one by one; what is damped is kept, and nothing is said of its loss."""
    springs = touched_at_once(Environment("stiff", Elastic, (Interval.point(F(61)),)), losable=True)
    assert [mode.name for mode in springs.modes] == ["a/soft+stiff/k-min", "a/soft+stiff/k-max"]
    rows = [velocity_mode(MOTION, laws.Admittance(F(1), F(2)), Elastic(F(k))) for k in (41, 106)]
    assert [mode.A.fractions() for mode in springs.modes] == rows
    assert springs.contact is not None
    assert any("each may be lost on its own" in text for text in words_of(springs))
    damped = Environment("hand", KelvinVoigt, (Interval.point(F(61)), Interval.point(F(1))))
    kept = touched_at_once(damped, losable=False)
    assert kept.contact is None
    assert any("none of them is lost on its own" in text for text in words_of(kept))
    assert any("Contact is not lost" in text for text in words_of(kept))


def touched_at_once(other, *, losable):
    soft = Environment("soft", Elastic, (Interval(F(43), F(41), F(45)),))
    both = touch_at_once((soft, other), losable=losable)
    controller = Controller("a", laws.Admittance(F(1), F(2)), "soft", (both.name,))
    return closed((soft, other, both), controller)
