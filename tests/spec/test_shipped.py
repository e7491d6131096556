from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.spec import SwitchedSystemSpec, load_spec
from nrs_design.spec.load import axes_at

from .samples import numbers

ROOT = Path(__file__).resolve().parents[2]
PATHS = sorted([*ROOT.glob("specs/**/*.nrs.yaml"), *ROOT.glob("docs/examples/*.nrs.yaml")])


def system(path: str) -> SwitchedSystemSpec:
    spec = load_spec(ROOT / path)
    assert isinstance(spec, SwitchedSystemSpec)
    return spec


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.name)
def test_names_are_those_of_the_files(path: Path) -> None:
    for axis in axes_at(path):
        file, _, name = axis.name.partition("#")
        said = file.removesuffix(".nrs.yaml") + f"-{name}" * bool(name)
        assert load_spec(axis).name == said


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
