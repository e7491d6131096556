"""State matrices entry by entry, against the published ones and against other formulas."""

from dataclasses import replace
from fractions import Fraction

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.laws import Admittance, IntegralForce, ProportionalForce
from nrs_design.controllers.sensor import LowPass
from nrs_design.errors import AssemblyError
from nrs_design.loop.modes import add_idle, position_mode, velocity_mode
from nrs_design.models.contact import Elastic, KelvinVoigt
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.thesis.switching import replace_by_force
from tests.loop.support import LOOP, MOTION, objects, polynomial, positive, stable
from tests.tables import by_rows

F = Fraction
# 752.69 N/m at 0.24 m, the stiffness in the printed matrices (43.355 N m/rad).
PRINTED = KelvinVoigt(F("752.69") * F("0.24") ** 2, F(0))
SOFT = KelvinVoigt(F("43.0356"), F(0))


class TestPublished:
    @pytest.mark.parametrize(("Bt", "entry"), [("2.15", -215), ("1.04", -104)])
    def test_matrices_of_thesis_6322(self, Bt, entry):
        """With -1618.80, as errata have it. The print's last row is good to five digits."""
        law = Admittance(F("0.01"), F(Bt))
        rows = replace_by_force(velocity_mode(MOTION, law, PRINTED), MOTION, PRINTED)
        assert rows[0] == [0, 1, 0, 0]
        assert rows[1] == [F("-1618.80"), F("-56.89"), -1, 0]
        assert rows[2] == [0, 0, entry, 100]
        assert rows[3] == [PRINTED.exact[0] * F("1618.80"), PRINTED.exact[0] * F("28.416"), 0, 0]
        assert float(rows[3][0]) == pytest.approx(70183.13, rel=2e-5)
        assert float(rows[3][1]) == pytest.approx(1231.97, rel=2e-5)

    @pytest.mark.parametrize(
        ("Bt", "eigenvalues"),
        [
            ("2.15", [-217.470, -14.694 + 32.617j, -14.694 - 32.617j, -25.031]),
            ("1.04", [-111.737, -5.424 + 39.978j, -5.424 - 39.978j, -38.306]),
        ],
    )
    @pytest.mark.parametrize("coordinates", ["deflection", "force"])
    def test_eigenvalues(self, Bt, eigenvalues, coordinates):
        rows = velocity_mode(MOTION, Admittance(F("0.01"), F(Bt)), SOFT)
        if coordinates == "force":
            rows = replace_by_force(rows, MOTION, SOFT)
        found = np.linalg.eigvals(np.array(rows, dtype=float))
        wanted = np.array(eigenvalues)
        for value in wanted:
            assert np.abs(found - value).min() < 2e-3
        for value in found:
            assert np.abs(wanted - value).min() < 2e-3


class TestImpedance:
    @given(positive, positive, positive, st.fractions(0, 10, max_denominator=100), st.booleans())
    def test_coordinates_are_similar(self, Mt, Bt, k, b, massless):
        law, contact = Admittance(F(0) if massless else Mt, Bt), KelvinVoigt(k, b)
        rows = velocity_mode(MOTION, law, contact)
        assert polynomial(replace_by_force(rows, MOTION, contact)) == polynomial(rows)

    def test_without_inertia(self):
        rows = velocity_mode(MOTION, Admittance(F(0), F(2)), KelvinVoigt(F(43), F(0)))
        assert rows == [
            [0, 1, 0],
            [F("-1618.80"), F("-56.89"), F(-43, 2)],
            [F("1618.80"), F("28.416"), 0],
        ]

    def test_damped_contact(self):
        rows = velocity_mode(MOTION, Admittance(F(1, 100), F(2)), KelvinVoigt(F(43), F(3)))
        assert rows[2] == [300 * F("1618.80"), 300 * F("28.416"), -200, 4300]


class TestSpring:
    """An admittance ``1/(Mt s + Bt + Kt/s)`` (thesis 2.2.6.2)."""

    # Kt may be zero: then there is no spring.
    maybe = st.fractions(0, 100, max_denominator=1000)
    parts = (positive, positive, maybe, positive, st.fractions(0, 10), st.booleans())

    @given(*parts)
    def test_characteristic_polynomial(self, Mt, Bt, Kt, k, b, massless):
        """den(s)(Mt s^2 + Bt s + Kt) + num(s)(b s + k), over its leading coefficient."""
        law = Admittance(F(0) if massless else Mt, Bt, Kt)
        rows = velocity_mode(MOTION, law, KelvinVoigt(k, b))
        num, den = (objects(*part) for part in (LOOP.numerator, LOOP.denominator))
        own, contact = objects(law.Mt, law.Bt, law.Kt), objects(b, k)
        total = np.polyadd(np.polymul(den, own), np.polymul(num, contact))
        total = np.trim_zeros(total, "f")
        assert polynomial(rows) == [c / total[0] for c in total]

    @given(*parts)
    def test_reference_and_deflection_tell_the_same(self, Mt, Bt, Kt, k, b, massless):
        """As a position loop with the reference for a state: that contact must be a spring."""
        law = Admittance(F(0) if massless else Mt, Bt, Kt)
        contact = Elastic(k)
        assert polynomial(position_mode(MOTION, law, contact)) == polynomial(
            velocity_mode(MOTION, law, contact)
        )

    def test_in_the_air_it_returns_to_its_reference(self):
        """Without a spring it stays anywhere: an eigenvalue of zero."""
        law = Admittance(F("0.01"), F("1.04"), F("0.5"))
        assert stable(velocity_mode(MOTION, law, KelvinVoigt(F(0), F(0))))
        assert not stable(velocity_mode(MOTION, replace(law, Kt=F(0)), KelvinVoigt(F(0), F(0))))

    def test_a_loop_that_does_not_follow_is_refused(self):
        motion = realize(MotionLoop((F(1), F(0)), (F(1), F(2), F(3))))
        with pytest.raises(AssemblyError, match="gain at zero is zero"):
            velocity_mode(motion, Admittance(F(1), F(1), F(1)), SOFT)


class TestFilter:
    @pytest.mark.parametrize("order", [1, 2, 3])
    def test_eigenvalues_are_the_poles_that_python_control_closes(self, order):
        """``G Ze H Y`` under unit feedback, H so many lags of 30 Hz in a row."""
        low_pass = LowPass(order, F(188))
        rows = velocity_mode(
            MOTION, Admittance(F("0.01"), F(2)), KelvinVoigt(F(43), F(1)), low_pass
        )
        s = control.tf("s")
        G = control.tf(*([*map(float, part)] for part in (LOOP.numerator, LOOP.denominator)))
        Ze, H, Y = (43 + s) / s, 1 / (s / 188 + 1) ** order, 1 / (0.01 * s + 2)
        wanted = np.sort_complex(control.feedback(G * Ze * H * Y, 1).poles())
        found = np.sort_complex(np.linalg.eigvals(np.array(rows, dtype=float)))
        assert found == pytest.approx(wanted, rel=1e-4)


class TestForce:
    @pytest.mark.slow
    @given(st.fractions(0, 1), positive)
    def test_state_feedback_of_thesis_646(self, Kp, k):
        rows = position_mode(MOTION, ProportionalForce(Kp), Elastic(k))
        assert rows == [[0, 1], [F("-1618.80") * (1 + Kp * k), F("-56.89") - Kp * k * F("28.416")]]

    def test_a_command_that_depends_on_itself(self):
        with pytest.raises(AssemblyError, match="depends on itself at once"):
            position_mode(MOTION, ProportionalForce(F(1)), KelvinVoigt(F(1), F(1)))


class TestOwnStates:
    @given(Kp=positive, Ki=positive, k=positive)
    def test_integral_of_the_force(self, Kp, Ki, k):
        """``s den(s) + k (Kp s + Ki) num(s)``."""
        rows = position_mode(MOTION, IntegralForce(Kp, Ki), Elastic(k))
        loop = np.polymul(objects(*LOOP.numerator), objects(k * Kp, k * Ki))
        assert polynomial(rows) == list(np.polyadd(objects(*LOOP.denominator, 0), loop))


@by_rows("rates", "expected")
def test_idle_states_decay_alone(rates, expected):
    assert add_idle([[F(1), F(2)], [F(3), F(4)]], rates) == expected
