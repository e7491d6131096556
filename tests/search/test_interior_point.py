"""Inequalities of forms by their definitions, and margins that are known."""

import numpy as np
import pytest
from nrs_design.search.cones import LARGEST_MULTIPLIER, ConeKind, FormsCones, FormTerm
from nrs_design.search.interior_point import maximize

from nrs_design.search.sdp import pack, unpack

RNG = np.random.default_rng(8)


def of_maps(matrices, rate=1.0):
    """Return the cones of ``Q - A'QA / rate^2 - t I`` for one form."""
    n = matrices.shape[-1]
    whole = np.eye(n)[None]
    M = np.swapaxes(matrices, -1, -2)
    terms = FormTerm(0, whole, whole), FormTerm(0, -M / rate**2, M)
    return FormsCones([n], 0, [ConeKind(terms, (), True, len(matrices), n)])


def of_everything():
    """Return cones with two forms, a flow, a map that leaves entries out, and a multiplier."""
    E, shorter = np.eye(3)[None], np.eye(4)[None, :, :3]
    N = RNG.normal(size=(2, 3, 3))
    M = RNG.normal(size=(5, 4, 3))
    C = RNG.normal(size=(5, 4, 4))
    kinds = [
        ConeKind((FormTerm(0, E, N), FormTerm(0, N, E)), (), True, 2, 3),
        ConeKind(
            (FormTerm(1, shorter, shorter), FormTerm(0, -M, M)),
            ((0, C + np.swapaxes(C, 1, 2)),),
            True,
            5,
            4,
        ),
    ]
    return FormsCones([3, 3], 1, kinds)


def test_operations_are_what_they_are_called():
    """The adjoint and the second derivative, from the images of all unknowns one by one."""
    cones = of_everything()
    images = [cones.image(unit) for unit in np.eye(cones.unknowns)]
    Ss = []
    for X in images[0]:
        half = RNG.normal(size=X.shape)
        Ss.append(half @ np.swapaxes(half, 1, 2))
    adjoint = [sum(float((a * S).sum()) for a, S in zip(A, Ss, strict=True)) for A in images]
    assert cones.adjoint(Ss) == pytest.approx(adjoint)
    moved = [[S @ a @ S for a, S in zip(A, Ss, strict=True)] for A in images]
    gram = [
        [sum(float((a * b).sum()) for a, b in zip(A, B, strict=True)) for B in moved]
        for A in images
    ]
    assert cones.gram(Ss) == pytest.approx(np.array(gram), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("a", [0.2, 0.9, 1.0, 1.3])
def test_one_state(a):
    """The trace is one, so the margin is ``1 - a^2``, of either sign."""
    found = maximize(of_maps(np.array([[[a]]])), None, accuracy=1e-9)
    assert found.forms[0][0, 0] == pytest.approx(1.0)
    # Where it is negative, that suffices.
    assert found.margin == pytest.approx(1 - a**2, abs=1e-6 if a <= 1 else 0.1)


def test_a_rotation_has_no_margin_and_a_round_form():
    turn = np.array([[[0.6, -0.8], [0.8, 0.6]]])
    assert abs(maximize(of_maps(turn), None).margin) < 1e-8
    found = maximize(of_maps(turn, 2.0), None, accuracy=1e-6)
    assert found.margin == pytest.approx(0.75, rel=1e-5)
    assert found.forms[0] == pytest.approx(np.eye(2), abs=1e-3)


@pytest.mark.parametrize("seed", range(6))
def test_the_margin_is_that_of_the_forms(seed):
    """Whatever its sign, and the bound of the dual is kept by other forms."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(4, 3, 3))
    A *= (0.3 + 0.25 * seed) / np.abs(np.linalg.eigvals(A)).max()
    found = maximize(of_maps(A), None, accuracy=1e-3)
    (Q,) = found.forms

    def margin(Q):
        return np.linalg.eigvalsh(Q - np.swapaxes(A, 1, 2) @ Q @ A)[:, 0].min()

    assert np.trace(Q) == pytest.approx(3.0)
    if found.margin > 0:
        assert margin(Q) >= found.margin * (1 - 1e-9)
    for _ in range(200):
        half = rng.normal(size=(3, 3))
        other = half @ half.T
        best = margin(3 * other / np.trace(other))
        assert best <= max(found.margin * (1 + 2e-3), 0.0) + 1e-9


def test_it_goes_on_from_what_was_found():
    A = np.array([[[0.9, 0.3], [0.0, 0.8]], [[0.7, 0.0], [0.3, 0.9]]])
    first = maximize(of_maps(A, 0.99), None)
    again = maximize(of_maps(A, 0.985), first, accuracy=1e-4)
    cold = maximize(of_maps(A, 0.985), None, accuracy=1e-4)
    assert again.margin == pytest.approx(cold.margin, rel=1e-3)


def test_a_multiplier_keeps_its_limit():
    """``Q - Q/2 + m >= t`` for one state: the largest t is that with the largest m."""
    one = np.ones((1, 1, 1))
    terms = FormTerm(0, one, one), FormTerm(0, -one / 2, one)
    cones = FormsCones([1], 1, [ConeKind(terms, ((0, one),), True, 1, 1)])
    found = maximize(cones, None, accuracy=1e-9)
    assert found.margin == pytest.approx(0.5 + LARGEST_MULTIPLIER, abs=1e-5)
    assert found.multipliers == pytest.approx([LARGEST_MULTIPLIER], abs=1e-5)


def test_it_ends_when_it_is_told_to_with_a_feasible_point():
    """Each step has a larger margin than all before it."""
    cones, margins = of_maps(np.array([[[0.9, 0.3], [0.0, 0.8]], [[0.7, 0.0], [0.3, 0.9]]])), []
    for steps in range(4):
        answers = iter([True] * steps + [False])
        found = maximize(cones, None, lambda answers=answers: next(answers))
        y = np.concatenate([pack(found.forms[0]), [found.margin]])
        assert min(np.linalg.eigvalsh(X).min() for X in cones.at(y)) > 0
        margins.append(found.margin)
    assert margins == sorted(margins)


def test_a_step_is_predicted_to_take_more_the_larger_it_is():
    small, large = (of_maps(np.zeros((m, n, n))).cost() for m, n in ((8, 10), (2, 64)))
    # Measured with one thread: 64 states and two modes take a second a step.
    assert small.work < 0.01
    assert 0.5 < large.work < 60
    assert large.memory > small.memory


def test_a_general_solver_is_told_the_same():
    """Its rows are the images of the unknowns, in both bounds of forms and in all edges."""
    cones = of_everything()
    matrix, offset, sizes = cones.for_solver()
    dense = np.zeros(matrix.shape)
    columns = np.repeat(np.arange(matrix.shape[1]), np.diff(matrix.indptr))
    dense[matrix.indices, columns] = matrix.data
    y = RNG.normal(size=cones.unknowns)
    (first, second), _ = cones.split(y)
    expected = [cones.at(y)[k][0] for k in (2, 3)]
    edges = [X for stack in cones.at(y)[4:] for X in stack]
    packed = offset - dense @ y
    found = [
        unpack(part, n)
        for part, n in zip(
            np.split(packed, np.cumsum([n * (n + 1) // 2 for n in sizes])[:-1]), sizes, strict=True
        )
    ]
    forms = [first - y[-1] * np.eye(3), np.eye(3) - first]
    forms += [second - y[-1] * np.eye(3), np.eye(3) - second]
    for X, other in zip(found, [*forms, *expected, *edges], strict=True):
        assert pytest.approx(other) == X
