"""Inputs of a sampled run: instants, commanded velocity, noise and delay of every sample."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.simulation.scenario import Array, Scenario


@dataclass(frozen=True, slots=True)
class SampleInputs:
    """Instants, commands, noise and delays, for every sample."""

    # times, hand, noise: shape (N,). Instants in s, commanded velocities in rad/s, errors of the
    # torque in N m.
    times: Array
    hand: Array
    noise: Array
    ages: NDArray[np.int64]  # Shape (N,). Of the force samples.

    @classmethod
    def of(
        cls, scenario: Scenario, period: float, delay: tuple[int, int], count: int
    ) -> SampleInputs:
        """Draw it from the seed of the scenario.

        Parameters
        ----------
        scenario : Scenario
            With its errors.
        period : float
            In s.
        delay : tuple of (int, int)
            Smallest and largest age.
        count : int
            Number of samples N.
        """
        rng = np.random.default_rng(scenario.seed)
        late = scenario.errors.jitter * period * rng.random(count)
        noise = scenario.errors.force_noise * rng.standard_normal(count)
        ages = rng.integers(delay[0], delay[1] + 1, count)
        times = period * np.arange(count) + late
        return cls(times, scenario.profile.at(times), noise, ages)
