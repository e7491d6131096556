"""Parameter boxes become corners."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import InternalError
from nrs_design.loop.assemble import assemble_from_text, corner_modes
from nrs_design.models.interval import Interval
from nrs_design.spec import parse_spec

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
        for i, row in enumerate(corner.A.fractions()):
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
