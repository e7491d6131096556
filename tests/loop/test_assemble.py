"""Assembled systems: given matrices, their boxes, designs from gains, and scaled ranges."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.gains import gains_of
from nrs_design.errors import AssemblyError, CertificateError, InternalError
from nrs_design.loop.assemble import GIVEN_MATRICES, assemble_from_text, corner_modes
from nrs_design.models.interval import Interval
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.mode import Time
from nrs_design.spec import LoadedSpec, load_spec, parse_spec, read_spec
from nrs_design.spec.build_plant import build_plant
from tests.support import COMMUTING, FORCE_LIMIT, ROOT, SOFT_TISSUE, words_of
from tests.tables import spec_text

GIVEN_LOOP = """motion_loop:
  transfer_function:
    numerator: [28.416, 1618.80]
    denominator: [1, 56.89, 1618.80]
"""


def design_of(path):
    loaded = read_spec(path)
    design = run_design(loaded).design
    return loaded.spec, design, gains_of(design)


def test_given_matrices():
    system = assemble_from_text(load_spec(COMMUTING), {})
    assert [mode.name for mode in system.modes] == ["a", "b"]
    assert system.modes[1].A.numerators == ((-2, 3), (-3, -2))
    assert system.time is Time.CONTINUOUS
    assert system.states == ("x1", "x2")
    assert system.assumptions == GIVEN_MATRICES


def test_decimals_are_read_exactly():
    spec = parse_spec(
        "kind: switched-system\nname: s\ntime: discrete\nswitching: arbitrary\n"
        "modes: [{name: a, A: [[-0.36, 1e-100], ['1/6', 0.1]]}]\n"
    )
    system = assemble_from_text(spec, {})
    assert system.modes[0].A.fractions() == [
        [Fraction(-9, 25), Fraction(1, 10**100)],
        [Fraction(1, 6), Fraction(1, 10)],
    ]
    assert system.time is Time.DISCRETE


def test_given_matrices_have_no_design():
    with pytest.raises(AssemblyError, match="have no gains"):
        assemble_from_text(load_spec(COMMUTING), {"motion": {}})


def test_designs_come_back_from_their_gains():
    spec, _, gains = design_of(SOFT_TISSUE)
    system = assemble_from_text(spec, gains)
    assert system.name == "soft-tissue"
    assert system.order == 4
    Bt = Fraction(gains["insertion"]["Bt"])
    Mt = Fraction(gains["insertion"]["Mt"])
    assert system.modes[0].A.fractions()[2][2] == -Bt / Mt


def test_a_motion_that_begins_with_a_force_may_have_a_filter_that_shows_it(tmp_path):
    text = (ROOT / "docs/examples/saturating.nrs.yaml").read_text("utf-8")
    filtered = text.replace("limits:", "sensor: {filter: {order: 2, cutoff: 20 Hz}}\nlimits:")
    path = tmp_path / "filtered.nrs.yaml"
    path.write_text(filtered, "utf-8")
    spec, _, gains = design_of(path)
    system = assemble_from_text(spec, gains)
    states = [[entry for (entry,) in x.fractions()] for x in system.saturation.start.states]
    shown = [(*(state[i] for i in (3, 4)),) for state in states]
    assert [system.states[i] for i in (3, 4)] == ["filtered 1 [N*m]", "filtered 2 [N*m]"]
    assert shown == [(0, 0), (1, 1), (0, 0), (1, 1)]
    assert all(state[5] > 0 and not any(state[:3]) for state in states)
    assert any("any part, each lag the same" in text for text in words_of(system))


def test_missing_gains():
    spec, _, gains = design_of(FORCE_LIMIT)
    with pytest.raises(CertificateError, match="gains"):
        assemble_from_text(spec, {"motion": gains["motion"]})


def test_motion_loop_that_the_spec_states():
    text = SOFT_TISSUE.read_text().replace("motion_loop:\n", GIVEN_LOOP)
    spec = parse_spec(text)
    _, design, _ = design_of(SOFT_TISSUE)
    loop = build_plant(spec).motion_loop(design.motion.Kp, design.motion.Kd)
    assert loop.numerator == (Fraction("28.416"), Fraction("1618.80"))
    assert loop.denominator == (Fraction(1), Fraction("56.89"), Fraction("1618.80"))


ENTRIES = ("0", "k", "-2 - k", "3/4*k - m + 0.5", "(k - r)/3", "m", "1/6", "r + m + k")
HALVES = st.fractions(-20, 20, max_denominator=4)


def box_system(parameters, modes, tail="switching: arbitrary", time="continuous"):
    listing = "".join(f"  {name}: {text}\n" for name, text in parameters.items())
    matrices = "".join(f"  - {{name: {name}, A: {A}}}\n" for name, A in modes.items())
    return parse_spec(
        f"kind: switched-system\nname: box\ntime: {time}\nparameters:\n{listing}"
        f"modes:\n{matrices}{tail}\n"
    )


def matrices(system):
    return {mode.name: mode.A.fractions() for mode in system.modes}


def test_oscillator_of_zelentsovsky():
    # x'' + x' + (2 + k) x with k in [0, 6]: the corners are the two modes of the publication.
    spec = box_system({"k": "{nominal: 3, range: [0, 6]}"}, {"x": "[[0, 1], [-2 - k, -1]]"})
    system = assemble_from_text(spec, {})
    assert matrices(system) == {"x/k-min": [[0, 1], [-2, -1]], "x/k-max": [[0, 1], [-8, -1]]}
    assert system.switching.is_arbitrary
    assert system.states == ("x1", "x2")


def test_each_mode_has_the_corners_of_what_it_depends_on():
    spec = box_system(
        {
            "k": "{nominal: 1, range: [0, 2]}",
            "r": '{nominal: "1/3"}',
            "q": "{nominal: 0, range: [-1, 1]}",
        },
        {"a": '[["k + r"]]', "b": "[[-1]]", "c": "[[k - q]]"},
    )
    assert matrices(assemble_from_text(spec, {})) == {
        "a/k-min": [[Fraction(1, 3)]],
        "a/k-max": [[Fraction(7, 3)]],
        "b": [[-1]],
        "c/k-min/q-min": [[1]],
        "c/k-min/q-max": [[-1]],
        "c/k-max/q-min": [[3]],
        "c/k-max/q-max": [[1]],
    }


def test_a_constant_parameter_is_at_both_ends_of_every_mode():
    spec = box_system(
        {"m": "{nominal: 1, range: [0, 2], varies: false}", "k": "{nominal: 1, range: [0, 2]}"},
        {"a": "[[m + k]]", "b": "[[-1]]"},
    )
    system = assemble_from_text(spec, {})
    assert system.switching.fixed_ends == (
        ("a/m-min/k-min", "a/m-max/k-min"),
        ("a/m-min/k-max", "a/m-max/k-max"),
        ("b", "b"),
    )
    named = {name for pair in system.switching.fixed_ends for name in pair}
    assert sorted(named) == sorted(mode.name for mode in system.modes)


def test_a_constant_parameter_of_one_value_makes_none():
    spec = box_system({"m": "{nominal: 1, varies: false}"}, {"a": "[[m]]"})
    system = assemble_from_text(spec, {})
    assert matrices(system) == {"a": [[1]]}
    assert system.switching.is_arbitrary


@pytest.mark.slow
@given(
    st.lists(st.sampled_from(ENTRIES), min_size=4, max_size=4),
    st.lists(st.tuples(HALVES, HALVES), min_size=3, max_size=3),
    st.lists(st.fractions(0, 1, max_denominator=7), min_size=3, max_size=3),
    st.booleans(),
)
def test_every_matrix_of_the_box_is_a_mean_of_corners(entries, ends, shares, varies):
    names = ("k", "m", "r")
    ranges = dict(zip(names, [tuple(sorted(pair)) for pair in ends], strict=True))
    a, b, c, d = entries
    listing = {
        name: f'{{nominal: "{low}", range: ["{low}", "{high}"]}}'
        for name, (low, high) in ranges.items()
    }
    listing["m"] = listing["m"][:-1] + f", varies: {str(varies).lower()}}}"
    modes = {"a": f'[["{a}", "{b}"], ["{c}", "{d}"]]', "all": '[["k + m + r"]]'}
    spec = box_system(
        listing,
        modes,
        "switching: arbitrary\nresets: [{from: a, to: all, map: [[1, 0]]}, "
        "{from: all, to: a, map: [[1], [0]]}]",
    )
    parameters = {n: Interval(ranges[n][0], *ranges[n]) for n in names}
    values = {
        n: low + share * (high - low)
        for share, (n, (low, high)) in zip(shares, ranges.items(), strict=True)
    }
    weights = dict(zip(names, shares, strict=True))
    corners = [*corner_modes(spec.modes[0], parameters)]
    mean = [[Fraction(0)] * 2 for _ in range(2)]
    for corner in corners:
        weight = Fraction(1)
        for label in corner.name.split("/")[1:]:
            name, _, end = label.partition("-")
            weight *= weights[name] if end == "max" else 1 - weights[name]
        for i, row in enumerate(corner.mode.A.fractions()):
            for j, entry in enumerate(row):
                mean[i][j] += weight * entry
    assert mean == spec.modes[0].matrix(values)


def test_a_bent_box_is_a_defect():
    class Bent:
        name, parameters = "a", {"k"}

        def matrix(self, values):
            return [[values["k"] ** 2]]

    k = Interval(Fraction(1), Fraction(0), Fraction(2))
    with pytest.raises(InternalError, match="mode a is not affine"):
        list(corner_modes(Bent(), {"k": k}))


BOX = parse_spec(
    "kind: switched-system\nname: s\ntime: continuous\nswitching: arbitrary\n"
    "parameters:\n  k: {nominal: 3, range: [1, 6]}\n"
    "  m: {nominal: 1, range: [0, 2], varies: false}\nmodes: [{name: a, A: [['-k - m']]}]\n"
)
TEXT = spec_text("hand")
HAND = parse_spec(TEXT)
SCALES = st.fractions(0, 4, max_denominator=9)


@pytest.fixture(scope="module")
def gains():
    return gains_of(run_design(LoadedSpec(path="hand", sha256="", text=TEXT, spec=HAND)).design)


def names(system):
    return [mode.name for mode in system.modes]


@given(SCALES, st.lists(st.fractions(-50, 50, max_denominator=9), min_size=3, max_size=3))
def test_intervals_keep_their_nominal_value(scale, values):
    low, nominal, high = sorted(values)
    found = Interval(nominal, low, high).scaled(scale)
    assert found.nominal == nominal
    assert nominal - found.low == scale * (nominal - low)
    assert found.high - nominal == scale * (high - nominal)


def test_parameters_are_scaled():
    half = assemble_from_text(BOX, {}, Fraction(1, 2))
    assert names(half) == ["a/k-min/m-min", "a/k-min/m-max", "a/k-max/m-min", "a/k-max/m-max"]
    assert [mode.A.fractions()[0][0] for mode in half.modes] == [
        Fraction(-5, 2),
        Fraction(-7, 2),
        -5,
        -6,
    ]
    assert {
        "Parameter k stays in [2, 4.5] and may change arbitrarily fast.",
        "All ranges of the spec are scaled about their nominal values by 1/2.",
    } <= set(words_of(half))


def test_scale_one_is_what_the_spec_says():
    assert assemble_from_text(BOX, {}, Fraction(1)) == assemble_from_text(BOX, {})
    assert not any("scaled" in text for text in words_of(assemble_from_text(BOX, {})))


def test_scale_zero_leaves_the_nominal_values():
    nominal = assemble_from_text(BOX, {}, Fraction(0))
    assert names(nominal) == ["a"]
    assert nominal.modes[0].A.fractions() == [[-4]]
    assert nominal.switching.is_arbitrary
    assert "Parameter k is 3." in words_of(nominal)


def test_environments_are_scaled(gains):
    whole = assemble_from_text(HAND, gains)
    double = assemble_from_text(HAND, gains, Fraction(4, 3))
    nominal = assemble_from_text(HAND, gains, Fraction(0))
    ends = ["k-min/b-min", "k-min/b-max", "k-max/b-min", "k-max/b-max"]
    assert names(whole) == names(double) == [f"insertion/hand/{end}" for end in ends]
    assert names(nominal) == ["insertion/hand"]
    # The row of the admittance velocity holds k/Mt: nominal 50, ends 25 and 90.
    centre = nominal.modes[0].A.fractions()[2][3]
    for mode, wide in zip(whole.modes, double.modes, strict=True):
        assert wide.A.fractions()[2][3] - centre == Fraction(4, 3) * (
            mode.A.fractions()[2][3] - centre
        )
    assert words_of(double)[-1] == (
        "All ranges of the spec are scaled about their nominal values by 4/3."
    )


def test_stiffness_stays_positive(gains):
    assemble_from_text(HAND, gains, Fraction("1.99"))
    with pytest.raises(AssemblyError, match="environment hand reaches a stiffness"):
        assemble_from_text(HAND, gains, Fraction(2))


def test_negative_scales_are_refused():
    with pytest.raises(AssemblyError, match="cannot be scaled by -1"):
        assemble_from_text(BOX, {}, Fraction(-1))


def test_has_ranges():
    assert BOX.has_ranges
    assert HAND.has_ranges
    untouched = TEXT.replace("environment: hand,", "environment: other,")
    assert parse_spec(untouched).has_ranges
    fixed = untouched.replace("{nominal: 1 N*m/rad, range: [0.25 N*m/rad, 2 N*m/rad]}", "1 N*m/rad")
    assert not parse_spec(fixed).has_ranges
    assert not parse_spec(
        "kind: switched-system\nname: s\ntime: discrete\nswitching: arbitrary\n"
        "parameters: {k: {nominal: 3}}\nmodes: [{name: a, A: [[k]]}]\n"
    ).has_ranges
    assert not parse_spec(
        untouched[: untouched.index("environments:")]
        + "controllers: {free: {type: position}}\nswitching: arbitrary\n"
    ).has_ranges
