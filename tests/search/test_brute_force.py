"""Verdicts against brute force: planar families by their worst angle, products of short cycles."""

from itertools import product

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search.certify import Limits, Verdict, certify
from tests.proof.systems import branicky, dayawansa_martin, family, oscillator, shears

ANGLES = 1200
# Nearer to the limit than this, the oracle of the planar families does not commit itself.
CLEAR = 0.01
LIMITS = Limits(max_degree=8, budget=5.0, optimize_rate=False)


def worst_growth(matrices: np.ndarray) -> float:
    """Return a number with the sign of the worst growth in the plane.

    With x at the angle t, ``h = x'Ax`` is the growth and ``g`` the turning of a mode. A family
    grows iff some average of modes keeps a direction and does not shrink along it (g = 0 and
    h >= 0), or the worst modes all the way around, once per sense of turning, gain in total
    (the integral of the largest h/g).
    """
    t = (np.arange(ANGLES) + 0.5) * np.pi / ANGLES
    x = np.stack([np.cos(t), np.sin(t)])
    across = np.stack([-np.sin(t), np.cos(t)])
    images = matrices @ x
    h, g = (images * x).sum(axis=1), (images * across).sum(axis=1)
    size = np.abs(matrices).max()
    worst = max(_along_rays(h, g) / size, -1.0)
    for turning in (g, -g):
        if (turning.max(axis=0) > 1e-9 * size).all():
            ratio = np.where(turning > 1e-9 * size, h / np.where(turning == 0, 1, turning), -np.inf)
            worst = max(worst, float(ratio.max(axis=0).sum() * np.pi / ANGLES))
    return worst


def _along_rays(h: np.ndarray, g: np.ndarray) -> float:
    """Return the largest growth along a direction that an average of modes keeps."""
    largest = -np.inf
    for i, j in product(range(len(h)), repeat=2):
        opposite = (g[i] >= 0) & (g[j] <= 0) & (g[i] - g[j] > 0)
        share = np.where(opposite, -g[j] / np.where(opposite, g[i] - g[j], 1), 0)
        mixed = share * h[i] + (1 - share) * h[j]
        largest = max(largest, mixed[opposite].max(initial=-np.inf))
    return float(largest)


def floats(system) -> np.ndarray:
    return np.array([mode.A.floats() for mode in system.modes])


def random_plane(seed: int):
    """Draw Hurwitz modes with decimals of one digit, every other family of them oscillating."""
    rng = np.random.default_rng(seed)
    modes = []
    while len(modes) < rng.integers(2, 4):
        A = rng.integers(-30, 31, size=(2, 2)) - np.diag(rng.integers(0, 30, size=2))
        if seed % 2:
            stiff, soft = rng.integers(1, 100), rng.integers(1, 10)
            A = np.array([[0, stiff], [-soft, 0]]) - np.diag(rng.integers(0, 20, size=2))
            A = A.T if rng.integers(2) else A
        if np.trace(A) < 0 and np.linalg.det(A) > 1:
            modes.append([[f"{entry}/10" for entry in row] for row in A.tolist()])
    return family(*modes)


@pytest.mark.parametrize(
    ("system", "sign"),
    [
        (dayawansa_martin("11.1"), -1),
        (dayawansa_martin("11.4"), 1),
        (oscillator("6.9"), -1),
        (oscillator("7.1"), 1),
        (branicky(), 1),
        (shears(), 1),
        (family([[-1, 0], [0, -2]], [[-3, 1], [0, -1]]), -1),
    ],
)
def test_the_oracle_knows_the_published_limits(system, sign):
    assert np.sign(worst_growth(floats(system))) == sign


def assert_no_contradiction(system) -> Verdict:
    found, growth = certify(system, limits=LIMITS), worst_growth(floats(system))
    if found.verdict is Verdict.PROVED:
        assert growth < CLEAR
        rate = found.evidence.proved_rate(system)
        # Shifted by less than the proved rate, the family is still stable.
        shifted = floats(system) + 0.9 * float(rate) * np.eye(2)
        assert worst_growth(shifted) < CLEAR
    if found.verdict is Verdict.REFUTED:
        assert growth > -CLEAR
    return found.verdict


def test_random_planar_families():
    verdicts = [assert_no_contradiction(random_plane(seed)) for seed in range(60)]
    assert verdicts.count(Verdict.PROVED) > 12
    assert verdicts.count(Verdict.REFUTED) > 12
    assert verdicts.count(Verdict.INCONCLUSIVE) < 6


@pytest.mark.slow
def test_many_more_random_planar_families():
    for seed in range(60, 2060):
        assert_no_contradiction(random_plane(seed))


def longest_growth(matrices: np.ndarray, length: int) -> float:
    """Return the largest spectral radius per step over all cycles up to a length."""
    largest, products = 0.0, np.eye(matrices.shape[1])[None]
    for k in range(1, length + 1):
        products = (products[:, None] @ matrices[None]).reshape(-1, *matrices.shape[1:])
        radius = np.abs(np.linalg.eigvals(products)).max()
        largest = max(largest, float(radius ** (1 / k)))
    return largest


def random_steps(seed: int):
    """Draw two modes, scaled so that their short cycles lie on both sides of one."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 4))
    matrices = rng.integers(-9, 10, size=(2, n, n)) + np.eye(n, dtype=int)
    bound = longest_growth(matrices.astype(float), 6) or 1.0
    scale = max(1, round(bound * rng.uniform(0.8, 1.25)))
    modes = [[[f"{e}/{scale}" for e in row] for row in A] for A in matrices.tolist()]
    return family(*modes, time=Time.DISCRETE)


def test_random_cycles_in_discrete_time():
    verdicts = []
    for seed in range(60):
        system = random_steps(seed)
        found, growth = certify(system, limits=LIMITS), longest_growth(floats(system), 10)
        verdicts.append(found.verdict)
        if found.verdict is Verdict.PROVED:
            assert growth <= float(found.evidence.proved_rate(system)) * (1 + 1e-9)
        if growth > 1 + 1e-9:
            assert found.verdict is not Verdict.PROVED
    assert verdicts.count(Verdict.PROVED) > 10
    assert verdicts.count(Verdict.REFUTED) > 10
