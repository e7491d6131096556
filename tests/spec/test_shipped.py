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

from .samples import numbers

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
        "tissue-x-withdrawal",
        "hand-range-no-mass",
        "retuned-gains",
        "hand-range",
        "wide-range",
        "flutter",
        "geromel-colaneri",
        "dayawansa-martin-6",
        "ando-shih",
        "oscillator-range",
        "unknown-constant",
    }


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_names_are_those_of_the_files(path: Path) -> None:
    assert load_spec(path).name == path.name.removesuffix(".nrs.yaml")


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "tissue-and-tool"])
def test_robot_of_the_thesis(name: str) -> None:
    # Thesis 4.1, 4.3 and 6.3.1.
    spec = design(name)
    assert spec.actuator.gain.nominal.exact == Fraction("4.8417e-4")
    assert spec.actuator.time_constant.nominal.exact == Fraction("0.0351")
    loop = spec.motion_loop
    assert loop.damping_ratio == Fraction("0.707")
    assert loop.settling_time.exact == 4 * spec.actuator.time_constant.nominal.exact
    assert loop.derivative_gain is not None
    assert loop.zero is not None
    # Kp = 117359.43 in the thesis.
    assert float(loop.derivative_gain.exact * loop.zero.exact) == pytest.approx(117359.43, rel=1e-6)
    assert spec.limits.torque.si / spec.limits.velocity.si == pytest.approx(2.1486, abs=5e-5)
    soft = spec.environments["soft"].at_pivot()["stiffness"]
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
    assert stiff.at_pivot()["stiffness"].nominal.si == pytest.approx(61.6608, abs=5e-5)
    assert [end.value for end in stiff.stiffness.range] == [Fraction("1055.4"), Fraction("1079.6")]
    for name, environment in (("tissue", "soft"), ("tool", "stiff")):
        controller = spec.controllers[name]
        assert isinstance(controller, ImpedanceControllerSpec)
        assert controller.environment == environment
        assert controller.contacts == ("soft", "stiff")


def test_commuting_modes_commute() -> None:
    # Narendra and Balakrishnan 1994.
    a, b = map(numbers, system("specs/examples/commuting.nrs.yaml").modes)
    n = range(2)

    def product(x: list[tuple[Fraction, ...]], y: list[tuple[Fraction, ...]]) -> object:
        return [[sum(x[i][k] * y[k][j] for k in n) for j in n] for i in n]

    assert product(a, b) == product(b, a)


def test_dayawansa_and_martin() -> None:
    for parameter in (5, 6):
        path = f"specs/examples/dayawansa-martin-{parameter}.nrs.yaml"
        a, b = map(numbers, system(path).modes)
        assert a == [(-1, -1), (1, -1)]
        assert b == [(-1, -parameter), (Fraction(1, parameter), -1)]


def test_print_error_is_as_printed() -> None:
    # Thesis 6.3.2.2.
    first, second = map(numbers, system("docs/examples/thesis-print-error.nrs.yaml").modes)
    assert first[1][0] == second[1][0] == Fraction("1618.80")
    assert first[3] == second[3] == (Fraction("70183.13"), Fraction("1231.97"), 0, 0)
    assert (first[2], second[2]) == ((0, 0, -215, 100), (0, 0, -104, 100))


def test_geromel_and_colaneri() -> None:
    spec = system("specs/examples/geromel-colaneri.nrs.yaml")
    stiff, soft = map(numbers, spec.modes)
    assert stiff == [(0, 1), (-10, -1)]
    assert soft == [(0, 1), (Fraction(-1, 10), Fraction(-1, 2))]
    assert spec.switching.dwell_time is not None
    # Shown by their condition from 2.75084 s on.
    assert spec.switching.dwell_time.value == Fraction("2.76")


def test_ando_and_shih() -> None:
    spec = system("specs/examples/ando-shih.nrs.yaml")
    c = Fraction("0.99")
    assert [numbers(mode) for mode in spec.modes] == [[(c, 0), (c, 0)], [(0, c), (0, -c)]]
    assert spec.time == "discrete"


def test_oscillator_is_within_the_limit_of_stability() -> None:
    # Zelentsovsky 1994: quadratic up to 3.82, stable up to 6.98513.
    spec = system("specs/examples/oscillator-range.nrs.yaml")
    low, high = spec.parameters["k"].range
    assert (low, spec.parameters["k"].varies) == (0, True)
    assert Fraction("3.82") < high < Fraction("6.98513")
    assert spec.modes[0].matrix({"k": high}) == [[0, 1], [-2 - high, -1]]


def test_constant_parameter_has_a_function_that_depends_on_it() -> None:
    # Q = [[2 + k + 1/2, 1/2], [1/2, 1]] is affine in k; its decrease in the ends and the mixed term
    # must all be negative, then it decreases for every constant k in the range.
    spec = system("specs/examples/unknown-constant.nrs.yaml")
    ends = spec.parameters["k"].range
    assert ends[1] > Fraction("6.98513")
    assert not spec.parameters["k"].varies

    def decrease(k_system: Fraction, k_function: Fraction) -> tuple[Fraction, Fraction, Fraction]:
        (_, one), (a, b) = spec.modes[0].matrix({"k": k_system})
        assert one == 1
        q11, q12, q22 = k_function + Fraction(5, 2), Fraction(1, 2), Fraction(1)
        assert q11 * q22 > q12**2
        return 2 * q12 * a, q11 + q12 * b + q22 * a, 2 * (q12 + q22 * b)

    low, high = ends
    mixed = zip(decrease(low, high), decrease(high, low), strict=True)
    for m11, m12, m22 in (decrease(low, low), decrease(high, high), [x + y for x, y in mixed]):
        assert m11 < 0
        assert m11 * m22 > m12**2


def test_flutter_is_stable_at_both_ends_only() -> None:
    # With K = [[10, 2], [-2, k]] and damping d, stable iff |Im mu| < d sqrt(Re mu) for mu of K.
    spec = system("docs/examples/flutter.nrs.yaml")
    low, high = spec.parameters["k"].range
    for k, stable in ((low, True), (Fraction(10), False), (high, True)):
        rows = spec.modes[0].matrix({"k": k})
        (a, b), (c, d) = ((-rows[i][0], -rows[i][2]) for i in (1, 3))
        half, square = (a + d) / 2, ((a - d) / 2) ** 2 + b * c
        assert (a, d, b * c) == (10, k, -4)
        # Real and positive, or a pair half +- i sqrt(-square).
        assert half > 0
        assert (square >= 0 and half**2 > square) is stable
        if not stable:
            assert -square > rows[1][1] ** 2 * half


def test_tissue_x_withdrawal_covers_tissue_and_tool() -> None:
    spec = design("tissue-x-withdrawal")
    low, high = spec.environments["tissue"].at_pivot()["stiffness"].range
    # Thesis 6.3.1 and 6.4.1: 747.1461 and 1070.5 N/m at 0.24 m.
    assert (low.exact, high.exact) == (43, 62)
    assert low.si < 43.0356 < 61.6608 < high.si
    assert gains(spec) == [("0.01", "2.15"), ("0.01", "1.04")]


@pytest.mark.parametrize(
    ("folder", "name", "Mt"),
    [("specs/neuroboscope", "hand-range-no-mass", "0"), ("docs/examples", "hand-range", "0.01")],
)
def test_range_of_hands(folder: str, name: str, Mt: str) -> None:
    # Tugal et al. 2022: 1002 +- 568 N/m.
    spec = load_spec(ROOT / folder / f"{name}.nrs.yaml")
    assert isinstance(spec, InteractionDesignSpec)
    hand = spec.environments["hand"]
    assert [end.value for end in hand.stiffness.range] == [1002 - 568, 1002 + 568]
    low, high = hand.at_pivot()["stiffness"].range
    assert (low.exact, high.exact) == (Fraction("24.9984"), Fraction("90.432"))
    assert gains(spec) == [(Mt, "2.15"), (Mt, "1.04")]


def test_retuned_gains_are_those_of_the_thesis_within_a_fifth() -> None:
    # Thesis 6.3.2.1: Mt = 0.01 with Bt = 2.15 and 1.04.
    spec = design("retuned-gains")
    for name, Bt in (("insertion", "2.15"), ("withdrawal", "1.04")):
        controller = spec.controllers[name]
        assert isinstance(controller, ImpedanceControllerSpec)
        for gain, value in ((controller.Mt, Fraction("0.01")), (controller.Bt, Fraction(Bt))):
            assert gain.range is not None
            assert [end.exact for end in gain.range] == [value * 4 / 5, value * 6 / 5]


def test_wide_range() -> None:
    spec = load_spec(ROOT / "docs/examples/wide-range.nrs.yaml")
    assert isinstance(spec, InteractionDesignSpec)
    (environment,) = spec.environments.values()
    assert [end.exact for end in environment.at_pivot()["stiffness"].range] == [1, 200]
    assert gains(spec) == [("0", "2.15")]


def gains(spec: InteractionDesignSpec) -> list[tuple[str, str]]:
    """Fixed inertia and damping of every impedance controller, as written."""
    found = []
    for controller in spec.controllers.values():
        assert isinstance(controller, ImpedanceControllerSpec)
        assert controller.Mt.fixed
        assert controller.Bt.fixed
        texts = (controller.Mt.min.text, controller.Bt.min.text)
        found.append((texts[0].partition(" ")[0], texts[1].partition(" ")[0]))
    return found


def test_a_controller_that_fails_is_unstable_only_then() -> None:
    # Philippe et al. 2016: A + B K with A = [[0.94, 0.56], [0.14, 0.46]] and K = [-0.49, 0.27].
    spec = system("specs/examples/failing-controller.nrs.yaml")
    gains = {"works": (1, 1), "first-fails": (0, 1), "second-fails": (1, 0), "both-fail": (0, 0)}
    rows = {
        name: [
            (Fraction("0.94"), Fraction("0.56")),
            (Fraction("0.14") - a * Fraction("0.49"), Fraction("0.46") + b * Fraction("0.27")),
        ]
        for name, (a, b) in gains.items()
    }
    assert {mode.name: numbers(mode) for mode in spec.modes} == rows
    # An eigenvalue beyond 1: the characteristic polynomial is negative there.
    (a, b), (c, d) = rows["both-fail"]
    assert (1 - a) * (1 - d) - b * c < 0


def test_two_ways_to_land() -> None:
    spec = system("docs/examples/contact-either-way.nrs.yaml")
    pair = system("specs/examples/geromel-colaneri.nrs.yaml")
    assert [numbers(mode) for mode in spec.modes] == [numbers(mode) for mode in pair.modes]
    assert len({(reset.source, reset.target) for reset in spec.resets}) == 1 < len(spec.resets)
