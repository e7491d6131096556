from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.spec import (
    ForceControllerSpec,
    ImpedanceControllerSpec,
    InteractionDesignSpec,
    SwitchedSystemSpec,
    load_spec,
)

ROOT = Path(__file__).resolve().parents[2]
PATHS = sorted([*ROOT.glob("specs/**/*.nrs.yaml"), *ROOT.glob("docs/examples/*.nrs.yaml")])


def design(name: str) -> InteractionDesignSpec:
    spec = load_spec(ROOT / "specs" / "neuroboscope" / f"{name}.nrs.yaml")
    assert isinstance(spec, InteractionDesignSpec)
    return spec


def system(path: str) -> SwitchedSystemSpec:
    spec = load_spec(ROOT / path)
    assert isinstance(spec, SwitchedSystemSpec)
    return spec


def test_all_are_found() -> None:
    assert {path.name.removesuffix(".nrs.yaml") for path in PATHS} >= {
        "soft-tissue",
        "force-limit",
        "tissue-and-tool",
        "commuting",
        "dayawansa-martin-5",
        "thesis-print-error",
    }


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_names_are_those_of_the_files(path: Path) -> None:
    assert load_spec(path).name == path.name.removesuffix(".nrs.yaml")


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "tissue-and-tool"])
def test_robot_of_the_thesis(name: str) -> None:
    # Thesis 4.1, 4.3 and 6.3.1.
    spec = design(name)
    assert spec.actuator.gain.exact == Fraction("4.8417e-4")
    assert spec.actuator.time_constant.exact == Fraction("0.0351")
    loop = spec.motion_loop
    assert loop.damping_ratio == Fraction("0.707")
    assert loop.settling_time.exact == 4 * spec.actuator.time_constant.exact
    assert loop.derivative_gain is not None
    assert loop.zero is not None
    # Kp = 117359.43 in the thesis.
    assert float(loop.derivative_gain.exact * loop.zero.exact) == pytest.approx(117359.43, rel=1e-6)
    assert spec.limits.torque.si / spec.limits.velocity.si == pytest.approx(2.1486, abs=5e-5)
    soft = spec.environments["soft"].rotational_stiffness
    assert soft.nominal.si == pytest.approx(43.0356, abs=5e-5)
    assert [end.value for end in spec.environments["soft"].stiffness.range] == [
        Fraction("720.56"),
        Fraction("768.17"),
    ]
    assert spec.design.significant_digits == 3


def test_soft_tissue_halves_the_impedance_of_withdrawal() -> None:
    spec = design("soft-tissue")
    insertion, withdrawal = spec.controllers["insertion"], spec.controllers["withdrawal"]
    assert isinstance(insertion, ImpedanceControllerSpec)
    assert isinstance(withdrawal, ImpedanceControllerSpec)
    assert insertion.desired_impedance_ratio is None
    assert withdrawal.desired_impedance_ratio == Fraction(1, 2)
    assert insertion.Mt.min.exact == withdrawal.Mt.min.exact == Fraction(1, 100)


def test_force_limit_has_the_gain_of_the_thesis() -> None:
    spec = design("force-limit")
    force = spec.controllers["force"]
    assert isinstance(force, ForceControllerSpec)
    assert force.proportional_gain is not None
    assert force.proportional_gain.exact == Fraction("0.02")
    assert spec.controllers["position"].type == "position"


def test_tissue_and_tool_meet_both_environments() -> None:
    # Thesis 6.1 and 6.4.1.
    spec = design("tissue-and-tool")
    stiff = spec.environments["stiff"]
    assert stiff.rotational_stiffness.nominal.si == pytest.approx(61.6608, abs=5e-5)
    assert [end.value for end in stiff.stiffness.range] == [Fraction("1055.4"), Fraction("1079.6")]
    for name, environment in (("tissue", "soft"), ("tool", "stiff")):
        controller = spec.controllers[name]
        assert isinstance(controller, ImpedanceControllerSpec)
        assert controller.environment == environment
        assert controller.contacts == ("soft", "stiff")


def test_commuting_modes_commute() -> None:
    # Narendra and Balakrishnan 1994.
    a, b = (mode.A for mode in system("specs/examples/commuting.nrs.yaml").modes)
    n = range(2)

    def product(x: tuple[tuple[Fraction, ...], ...], y: tuple[tuple[Fraction, ...], ...]) -> object:
        return [[sum(x[i][k] * y[k][j] for k in n) for j in n] for i in n]

    assert product(a, b) == product(b, a)


def test_dayawansa_and_martin() -> None:
    a, b = (mode.A for mode in system("specs/examples/dayawansa-martin-5.nrs.yaml").modes)
    assert list(a) == [(-1, -1), (1, -1)]
    assert list(b) == [(-1, -5), (Fraction(1, 5), -1)]


def test_print_error_is_as_printed() -> None:
    # Thesis 6.3.2.2.
    first, second = (mode.A for mode in system("docs/examples/thesis-print-error.nrs.yaml").modes)
    assert first[1][0] == second[1][0] == Fraction("1618.80")
    assert first[3] == second[3] == (Fraction("70183.13"), Fraction("1231.97"), 0, 0)
    assert (first[2], second[2]) == ((0, 0, -215, 100), (0, 0, -104, 100))
