"""Bounds on norms against eigenvalues and runs in floating point."""

import numpy as np

from nrs_design.robot.models.enclosure.balls import Balls
from nrs_design.robot.models.enclosure.norms import directions, form_norm, norm


def symmetric(shape, seed):
    A = np.random.default_rng(seed).normal(size=(*shape, 3, 3))
    return A + np.swapaxes(A, -1, -2)


def balls(A, rad=0.0):
    return [[Balls(A[..., i, j], rad) for j in range(3)] for i in range(3)]


def test_norm_is_the_largest_eigenvalue_and_hardly_more():
    A = symmetric((500,), 1)
    ratio = norm(balls(A)) / np.abs(np.linalg.eigvalsh(A)).max(axis=-1)
    assert ratio.min() >= 1
    assert ratio.max() < 1.001


def test_norm_of_zero_and_of_what_is_tiny():
    assert norm(balls(np.zeros((1, 3, 3))))[0] < 1e-50
    assert 1e-30 <= norm(balls(1e-30 * np.eye(3)[None]))[0] < 1.001e-30


def test_every_matrix_in_the_balls():
    A, B = symmetric((200,), 2), symmetric((200,), 3)
    moved = np.abs(np.linalg.eigvalsh(A + 0.1 * np.clip(B, -1, 1))).max(axis=-1)
    assert np.all(moved <= norm(balls(A, 0.1)))


def test_form_norm_against_many_directions():
    F = symmetric((40, 3), 4)
    bound = form_norm([balls(F[:, c]) for c in range(3)])
    v = np.random.default_rng(5).normal(size=(20_000, 3))
    v /= np.linalg.norm(v, axis=1)[:, None]
    torque = np.einsum("nc ij,vi,vj->nvc".replace(" ", ""), F, v, v)
    found = np.linalg.norm(torque, axis=-1).max(axis=1)
    assert np.all(bound >= found)
    assert np.all(bound <= 1.05 * found)


def test_what_is_enough_is_not_looked_at_again():
    F = symmetric((5, 3), 6)
    forms = [balls(F[:, c]) for c in range(3)]
    coarse = form_norm(forms, np.inf)
    assert np.all(coarse >= form_norm(forms))
    assert np.allclose(coarse, np.sqrt((F**2).sum(axis=(1, 2, 3))))


def test_directions_surround_the_ball():
    u, inside = directions()
    assert np.allclose(np.linalg.norm(u, axis=0), 1)
    v = np.random.default_rng(7).normal(size=(1000, 3))
    v /= np.linalg.norm(v, axis=1)[:, None]
    # The body is the hull of the points and their opposites: it reaches far enough everywhere.
    assert 0.95 < inside <= np.abs(v @ u).max(axis=1).min()
