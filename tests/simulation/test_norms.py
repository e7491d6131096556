import numpy as np
import pytest

from nrs_design.simulation.norms import polynomial_norm, quadratic_norm, scaled_matrices


def test_quadratic_norm_of_known_vectors():
    norm = quadratic_norm(np.array([[2.0, 1.0], [1.0, 3.0]]))
    assert norm(np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])) == pytest.approx(
        [2**0.5, 3**0.5, 7**0.5]
    )


def test_polynomial_norm_is_the_root_of_the_form():
    # z = (x^2, xy, y^2), V = x^4 + x^2 y^2 + 3 y^4.
    norm = polynomial_norm(((1, 0, 0), (0, 1, 0), (0, 0, 3)), 2, 2)
    values = norm(np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 2.0]]))
    assert values / values[0] == pytest.approx([1.0, 3**0.25, (1 + 4 + 48) ** 0.25])


def test_integers_beyond_doubles_keep_their_ratios():
    huge = 10**400
    Q = ((huge, 0), (0, 4 * huge))
    norm = polynomial_norm(Q, 1, 2)
    values = norm(np.eye(2))
    assert values[1] / values[0] == pytest.approx(2.0)
    assert scaled_matrices(Q)[0] == pytest.approx(np.diag([0.25, 1.0]))
