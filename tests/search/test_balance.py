import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.search.balance import balance, scale_states


def test_published_example():
    # A standard example of bad scaling (Osborne 1960): the entries span 10^4 each way.
    A = np.array([[[1.0, 1e4], [1e-4, 1.0]]])
    scaled = scale_states(A, balance(A))
    assert np.abs(scaled).max() < 2.1


@given(st.lists(st.integers(-60, 60), min_size=3, max_size=3), st.integers(0, 99))
def test_undoes_any_scaling_by_powers_of_two(exponents, seed):
    A = np.random.default_rng(seed).uniform(0.5, 1.0, (2, 3, 3))
    spoiled = scale_states(A, np.array(exponents))
    scaled = scale_states(spoiled, balance(spoiled))
    off_diagonal = np.abs(scaled).sum(axis=0)[~np.eye(3, dtype=bool)]
    assert off_diagonal.max() / off_diagonal.min() < 64


@given(st.integers(0, 99))
def test_scaling_is_exact_and_can_be_undone(seed):
    generator = np.random.default_rng(seed)
    A = generator.standard_normal((2, 4, 4))
    d = generator.integers(-100, 100, 4)
    np.testing.assert_array_equal(scale_states(scale_states(A, d), -d), A)
    powers = 2.0**d
    np.testing.assert_array_equal(
        scale_states(A, d), A * powers[None, None, :] / powers[None, :, None]
    )


@pytest.mark.parametrize(
    "A",
    [
        np.zeros((1, 2, 2)),
        np.eye(3)[None],
        np.array([[[0.0, 1.0], [0.0, 0.0]]]),
        np.ones((1, 1, 1)),
    ],
)
def test_nothing_to_balance(A):
    np.testing.assert_array_equal(balance(A), 0)


def test_entries_at_the_ends_of_the_range():
    for big in (1e200, 1e-200):
        A = np.array([[[0.0, big], [1 / big, 0.0]]])
        assert np.abs(scale_states(A, balance(A))).max() < 3
    with np.errstate(all="ignore"):
        assert np.isfinite(balance(np.array([[[0.0, np.inf], [1.0, 0.0]]]))).all()
