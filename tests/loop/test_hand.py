"""A hand with a mass in the proof: its equations solved another way, known answers, refusals.

The verdicts were found by an independent program.
"""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import SpecError
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.search.certify import Limits, certify
from nrs_design.spec import parse_spec
from tests.loop.support import assembled, loaded
from tests.support import ROOT, replaced

PATH = ROOT / "docs/examples/hand-with-mass.nrs.yaml"
TEXT = PATH.read_text(encoding="utf-8")
BOTH = TEXT[TEXT.index("  lively:") : TEXT.index("switching:")]
MASS = "mass: {nominal: 0.1 kg*m^2, range: [0 kg*m^2, 0.2 kg*m^2]}"
DAMPING = "{nominal: 7 N*m*s/rad, range: [4 N*m*s/rad, 10 N*m*s/rad]}"


def system_of(*changes):
    return assembled(PATH, *changes)


def implicit(k, b, m, Mt, Bt):
    """Eigenvalues of the loop as a pencil, the acceleration an unknown of its own.

    States theta, omega, e, vm; ``tau omega' = Km (Kp e + Kd (-vm - omega)) - omega``,
    ``e' = -vm - omega`` and ``Mt vm' + Bt vm = k theta + b omega + m omega'``.
    """
    Km, tau, Kd = 4.8417e-4, 0.0351, 2060.0
    Kp = Kd * 56.9706
    E = np.eye(4)
    E[3] = [0, -m, 0, Mt]
    A = np.array(
        [
            [0, 1, 0, 0],
            [0, -(1 + Km * Kd) / tau, Km * Kp / tau, -Km * Kd / tau],
            [0, -1, 0, -1],
            [k, b, 0, -Bt],
        ]
    )
    return np.sort_complex(np.linalg.eigvals(np.linalg.solve(E, A)))


def test_the_modes_are_the_loop_with_the_mass():
    system = system_of()
    corners = {"k": ("25", "90.4"), "b": ("4", "10"), "m": ("0", "0.2")}
    assert len(system.modes) == 16
    for mode in system.modes:
        name, _, *ends = mode.name.split("/")
        values = [float(corners[e[0]][e.endswith("max")]) for e in ends]
        expected = implicit(*values, 2.0, 4.0 if name == "lively" else 8.0)
        found = np.sort_complex(np.linalg.eigvals(np.array(mode.A.floats())))
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_the_stiffness_limit_of_the_design_takes_damping_and_mass_along():
    for item in run_analysis(run_design(loaded(PATH))).impedance:
        limit = item.lowest_limit
        Bt = 4.0 if item.name == "lively" else 8.0
        worst = [
            max(
                max(implicit(share * limit, b, m, 2, Bt).real) for b in (4, 7, 10) for m in (0, 0.2)
            )
            for share in (0.999, 1.001)
        ]
        assert worst[0] < 0 < worst[1]


def test_a_motor_in_ranges_is_covered_with_the_mass():
    gain = "gain: {nominal: 4.8417e-4 rad/s/rpm, range: [4.8e-4 rad/s/rpm, 4.9e-4 rad/s/rpm]}"
    calm = BOTH[BOTH.index("  calm") :]
    system = system_of(("gain: 4.8417e-4 rad/s/rpm", gain), (BOTH, calm))
    assert len(system.modes) == 16
    found = certify(system, limits=Limits(optimize_rate=False))
    assert found.verdict is Verdict.PROVED


@pytest.mark.parametrize(("Mt", "Bt"), [(1, 4), (1, 8), (2, 8), (3, 8)])
def test_hands_of_2_to_6_without_mass(Mt, Bt):
    one = f"  one: {{type: impedance, environment: hand, Mt: {Mt} kg*m^2, Bt: {Bt} N*m*s/rad}}\n"
    few = "{nominal: 4 N*m*s/rad, range: [2 N*m*s/rad, 6 N*m*s/rad]}"
    system = system_of((BOTH, one), (MASS, "mass: 0 kg*m^2"), (DAMPING, few))
    assert certify(system, limits=Limits(optimize_rate=False)).verdict is Verdict.PROVED


def test_a_mass_that_changes_too_much_is_refuted():
    """Every constant mass of the range is stable; one that moves along with the hand is not."""
    heavy = "mass: {nominal: 0.1 kg*m^2, range: [0 kg*m^2, 3 kg*m^2]}"
    system = system_of((MASS, heavy))
    assert all(max(implicit(90.4, 4, m, 2, 4).real) < 0 for m in (0, 1, 2, 3))
    # Found by the search for periods, with more digits.
    names = "lively/hand/k-min/b-min/m-max", "lively/hand/k-max/b-min/m-min"
    period = zip(names, (Fraction(1, 2), Fraction(1, 4)), strict=True)
    assert GrowingSequence(tuple(period), 4).find_fault(system) is None


def test_a_massless_admittance_beside_a_mass_depends_on_itself():
    soft = "environments:\n  soft: {model: elastic, stiffness: 40 N*m/rad}"
    changed = ("environments:", soft), ("Mt: 2 kg*m^2, Bt: 4", "Mt: 0 kg*m^2, Bt: 4")
    with pytest.raises(SpecError, match="depends on itself"):
        parse_spec(replaced(TEXT, *changed))


def test_a_mass_at_a_lever_arm_is_turned():
    linear = TEXT.replace("N*m/rad", "N/m").replace(DAMPING, "7 N*s/m")
    linear = linear.replace(MASS, "mass: 1 kg\n    lever_arm: 0.5 m")
    turned = parse_spec(linear).environments["hand"].exact_at_pivot()
    assert turned["mass"].nominal == pytest.approx(0.25)
