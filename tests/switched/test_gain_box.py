"""Ranges of virtual inertia and damping, from the spec to the modes and their proof."""

from fractions import Fraction
from itertools import product

import pytest

from nrs_design.controllers.gains import gains_of
from nrs_design.controllers.laws import Admittance, ProportionalForce
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import AssemblyError
from nrs_design.models.interval import Interval
from nrs_design.pipeline import run_design
from nrs_design.search.certify import Limits, Verdict, certify
from nrs_design.spec import LoadedSpec, parse_spec, read_spec
from nrs_design.switched.assemble import DECLARED, assemble_from_text
from nrs_design.switched.gain_box import GainBox, RangedLaw
from tests.proof.graphs import shape_of
from tests.support import ROOT
from tests.switched.frames import frame_of

F = Fraction
TEXT = """\
kind: interaction-design
name: hand
actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}
motion_loop: {damping_ratio: 0.707, settling_time: 0.1404 s, derivative_gain: 2060 rpm*s/rad,
              zero: 56.9706 1/s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments: {soft: {model: kelvin-voigt, stiffness: STIFF, damping: DAMP}}
controllers:
  insertion: {type: impedance, environment: soft, Mt: MASS, Bt: BT}
switching: arbitrary
"""
TISSUE = "{nominal: 43 N*m/rad, range: [41 N*m/rad, 45 N*m/rad]}"
JELLY = "{nominal: 0.1 N*m*s/rad, range: [0 N*m*s/rad, 0.2 N*m*s/rad]}"
MASS = "{nominal: 0.0125 kg*m^2, range: [0.01 kg*m^2, 0.02 kg*m^2]}"
BT = "{nominal: 2 N*m*s/rad, range: [1.75 N*m*s/rad, 2.5 N*m*s/rad]}"
FIXED = {"STIFF": "43.0356 N*m/rad", "DAMP": "0 N*m*s/rad", "MASS": "0.01 kg*m^2"}


def loaded(**fields):
    text = TEXT
    for key, value in (FIXED | fields).items():
        text = text.replace(f" {key}", f" {value}", 1)
    return LoadedSpec(path="hand", sha256="", text=text, spec=parse_spec(text))


def assembled(spec, scale=DECLARED):
    return assemble_from_text(spec.spec, gains_of(run_design(spec).design), scale)


class TestPublished:
    def test_ends_are_the_modes_of_the_thesis(self):
        """Thesis 6.3.2.1: Mt = 0.01 with Bt = 1.04 and 2.15, of which a common quadratic exists."""
        damping = "{nominal: 1.04 N*m*s/rad, range: [1.04 N*m*s/rad, 2.15 N*m*s/rad]}"
        system = assembled(loaded(BT=damping))
        assert [mode.name for mode in system.modes] == [
            "insertion/soft/Bt-min",
            "insertion/soft/Bt-max",
        ]
        low, high = (mode.A.fractions() for mode in system.modes)
        # -Bt/Mt, with both in single precision: -104 and -215 in the print.
        assert float(low[2][2]) == pytest.approx(-104, rel=1e-6)
        assert float(high[2][2]) == pytest.approx(-215, rel=1e-6)
        found = certify(system, limits=Limits(optimize_rate=False))
        assert found.verdict is Verdict.PROVED
        assert shape_of(found.evidence) == "conewise-quadratic"

    def test_too_soft_a_corner_is_refuted(self):
        """With Mt = 0.01 and Bt = 1.04 the loop is unstable from 75.9 N m/rad on."""
        damping = "{nominal: 2.15 N*m*s/rad, range: [1.04 N*m*s/rad, 2.15 N*m*s/rad]}"
        for stiffness, verdict in (("76.5", Verdict.REFUTED), ("60", Verdict.PROVED)):
            system = assembled(loaded(STIFF=f"{stiffness} N*m/rad", BT=damping))
            found = certify(system, limits=Limits(optimize_rate=False))
            assert found.verdict is verdict
            if verdict is Verdict.REFUTED:
                assert found.evidence.names_unstable_mode
                assert found.evidence.steps[0][0] == "insertion/soft/Bt-min"


class TestCorners:
    def test_one_mode_for_each(self):
        system = assembled(loaded(STIFF=TISSUE, DAMP=JELLY, MASS=MASS, BT=BT))
        ends = product(*([f"{symbol}-min", f"{symbol}-max"] for symbol in ("k", "b", "Mt", "Bt")))
        assert [m.name for m in system.modes] == [f"insertion/soft/{'/'.join(e)}" for e in ends]


class TestStatements:
    def test_assumptions_say_where_gains_are_and_what_is_kept(self):
        texts = assembled(loaded(MASS=MASS, BT=BT)).assumptions
        assert texts[-4:] == (
            "The gains are the single-precision numbers listed here, or anywhere in their ranges.",
            # 0.01 and 0.02 in single precision are below: the lower end moves with it.
            "Mt of insertion stays in [0.00999999977648258209228515625, 0.02] kg*m^2 and may "
            "change arbitrarily fast.",
            "Bt of insertion stays in [1.75, 2.5] N*m*s/rad and may change arbitrarily fast.",
            "While a gain changes, the admittance keeps its velocity vm: the controller "
            "integrates vm' = (F - Bt vm)/Mt with the gains of the moment. One that keeps Mt vm, "
            "or another memory of a filter, is not covered.",
        )

    def test_without_inertia_nothing_is_kept(self):
        texts = assembled(loaded(MASS="0 kg*m^2", BT=BT)).assumptions
        assert texts[-1].startswith("With Mt = 0 the admittance has no memory")
        assert not any("keeps its velocity" in text for text in texts)

    def test_without_ranges_nothing_is_added(self):
        texts = assembled(loaded(BT="2 N*m*s/rad")).assumptions
        assert texts[-1] == "The gains are the single-precision numbers listed here."

    def test_has_ranges(self):
        assert loaded(BT=BT).spec.has_ranges
        assert loaded(MASS=MASS, BT="2 N*m*s/rad").spec.has_ranges
        assert not loaded(BT="2 N*m*s/rad").spec.has_ranges
        assert not loaded(BT="{min: 1 N*m*s/rad, max: 9 N*m*s/rad}").spec.has_ranges


class TestScale:
    def test_gains_are_stretched_about_what_ships(self):
        spec = loaded(MASS=MASS, BT=BT)
        nominal = assembled(spec, scale=F(0))
        assert [mode.name for mode in nominal.modes] == ["insertion/soft"]
        assert nominal.assumptions[-2] == "The gains are the single-precision numbers listed here."
        double = assembled(spec, scale=F(2))
        assert "Bt of insertion stays in [1.5, 3] N*m*s/rad and may change arbitrarily fast." in (
            double.assumptions
        )

    @pytest.mark.parametrize(("gain", "scale"), [("MASS", 5), ("BT", 8)])
    def test_gains_stay_positive(self, gain, scale):
        fields = {"BT": "2 N*m*s/rad"} | {gain: {"MASS": MASS, "BT": BT}[gain]}
        spec = loaded(**fields)
        assembled(spec, scale=F(scale) - F(1, 10))
        name = {"MASS": "Mt", "BT": "Bt"}[gain]
        with pytest.raises(AssemblyError, match=f"gain {name} of controller insertion does not"):
            assembled(spec, scale=F(scale))

    def test_a_point_may_be_zero(self):
        law = Admittance(F(0), F(2))
        box = GainBox(law, {"Mt": Interval.point(F(0)), "Bt": Interval(F(2), F(1), F(3))})
        assert box.scaled(F(1, 2), "in").ranges["Bt"] == Interval(F(2), F(3, 2), F(5, 2))
        assert not box.fixed
        assert GainBox.point(law).fixed


def test_shipped_example_needs_a_polynomial():
    spec = read_spec(ROOT / "specs" / "neuroboscope" / "retuned-gains.nrs.yaml")
    system = assembled(spec)
    assert len(system.modes) == 16
    found = certify(system, limits=Limits(max_degree=4, optimize_rate=False))
    assert (found.verdict, str(found.common_quadratic)) == (Verdict.PROVED, "impossible")


PERIOD = Fraction(1, 500)


def ranged_law(Mt, Bt, Kt=(0, 0)):
    ranges = [Interval(*map(Fraction, (low, low, high))) for low, high in (Mt, Bt, Kt)]
    law = Admittance(*(interval.nominal for interval in ranges))
    names = ("Mt", "Bt", "Kt") if law.Kt else ("Mt", "Bt")
    box = GainBox(law, dict(zip(names, ranges, strict=False)))
    return RangedLaw.of(law.discretize(PERIOD, "exact"), box, PERIOD, "exact")


def test_a_point_is_the_law_that_ships():
    gains = ranged_law(("0.01", "0.01"), (2, 2))
    assert not gains.box.ranges
    assert gains.at({"k": Fraction(3)}) is gains.law
    force = ProportionalForce(Fraction(1, 50)).discretize(PERIOD, "exact")
    assert (
        RangedLaw.of(force, GainBox.point(Admittance(*[Fraction(1)] * 2)), PERIOD, "").law is force
    )


def test_the_law_at_a_corner():
    gains = ranged_law(("0.01", "0.01"), (1, 2), ("0.5", 1))
    assert set(gains.box.ranges) == {"a", "c", "Kt"}
    law = gains.at({"a": Fraction(1, 2), "c": Fraction(3, 4), "Kt": Fraction(1), "k": Fraction(9)})
    T = gains.law.numbers["T"]
    assert law.numbers == {"a": Fraction(1, 2), "b": Fraction(3, 8), "T": T, "Kt": 1}


def test_without_inertia_b_is_in_a_range_itself():
    gains = ranged_law((0, 0), (1, 2))
    assert gains.at({"c": Fraction(3, 4)}).numbers["b"] == Fraction(3, 4)
    assert "b of x stays in [0.5, 1]" in " ".join(gains.texts("x"))


def test_corners_hold_what_lies_between_them():
    """The rows of a frame are affine in a, c and Kt: the box checks that exactly, and yields 8."""
    step = StepFrame(Fraction(10**5), Fraction(10**6))
    for springs in (("0.5", 1), (0, 0)):
        gains = ranged_law(("0.01", "0.02"), (1, 2), springs)
        frame = frame_of(PERIOD, step, (gains.law,), 1, Fraction(1, 20))
        motor = {"Km": Fraction(1, 2000), "E": Fraction(9, 10), "k": Fraction(43)}

        def rows_at(values, frame=frame, motor=motor, gains=gains):
            return frame.rows(gains.at(values), 0, {**motor, **values})

        assert len(list(gains.box.corners(rows_at, "x"))) == (
            8 if gains.law.numbers.get("Kt") else 4
        )


def test_a_box_in_which_single_precision_loses_a_coefficient_is_no_loop():
    with pytest.raises(AssemblyError, match="loses a coefficient"):
        ranged_law((1, 10**7), (1, 1))
