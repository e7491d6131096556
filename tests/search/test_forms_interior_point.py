"""The interior-point method for forms: its operations by their definitions, and known margins."""

import numpy as np
import pytest

from nrs_design.search.forms_interior_point import ConeKind, FormsCones, FormTerm, maximize

RNG = np.random.default_rng(8)


def of_maps(matrices, rate=1.0):
    """Return the cones of ``Q - A'QA / rate^2 - t I`` for one form."""
    n = matrices.shape[-1]
    whole = np.eye(n)[None]
    M = np.swapaxes(matrices, -1, -2)
    terms = FormTerm(0, whole, whole), FormTerm(0, -M / rate**2, M)
    form = ConeKind(0.0, (FormTerm(0, whole, whole),), (), False, 1, n)
    return FormsCones([n], 0, [form, ConeKind(0.0, terms, (), True, len(matrices), n)])


def of_everything():
    """Return cones with two forms, a flow, a map that leaves entries out, and a multiplier."""
    E, shorter = np.eye(3)[None], np.eye(4)[None, :, :3]
    N = RNG.normal(size=(2, 3, 3))
    M = RNG.normal(size=(5, 4, 3))
    C = RNG.normal(size=(5, 4, 4))
    kinds = [
        ConeKind(0.0, (FormTerm(0, E, E),), (), False, 1, 3),
        ConeKind(2.0, (), ((0, -np.ones((1, 1, 1))),), False, 1, 1),
        ConeKind(0.0, (FormTerm(0, E, N), FormTerm(0, N, E)), (), True, 2, 3),
        ConeKind(
            0.0,
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
    """``Q - Q/2 + m >= t`` for one state, with ``0 <= m <= 2``: the largest t is 2.5."""
    one = np.ones((1, 1, 1))
    kinds = [
        ConeKind(0.0, (FormTerm(0, one, one),), (), False, 1, 1),
        ConeKind(0.0, (), ((0, one),), False, 1, 1),
        ConeKind(2.0, (), ((0, -one),), False, 1, 1),
        ConeKind(0.0, (FormTerm(0, one, one), FormTerm(0, -one / 2, one)), ((0, one),), True, 1, 1),
    ]
    found = maximize(FormsCones([1], 1, kinds), None, accuracy=1e-9)
    assert found.margin == pytest.approx(2.5, abs=1e-6)
    assert found.multipliers == pytest.approx([2.0], abs=1e-6)


def test_no_steps_are_no_answer():
    A = np.array([[[0.5]]])
    assert maximize(of_maps(A), None, lambda: False).margin < 0.75
