"""Chapters 2.5 and 6.1: laws of nose and concha, and the silicone specimens."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from decimal import ROUND_FLOOR, Decimal
from statistics import fmean
from typing import Any

from nrs_design.models.contact import Elastic, KelvinBoltzmann, Maxwell
from nrs_design.thesis.comparison import Recomputed, Result, format_number, read_data

# Thesis 6.2: the compliant controllers, which the laws are for, ran every 0.1 ms on a computer; the
# motion loop at 500 Hz on the processor. How often the records of 6.1 were sampled is not printed.
PERIOD = 1e-4
# Lever arm of 6.3.1 in m, and the stiffness there and in 6.4.1.
ARM = 0.24


def tissue() -> Iterator[Result]:
    """Convert the coefficients, and hold the text against the tables."""
    tissues = read_data("tables.yaml")["tissue"]
    times = [damping / stiffness for stiffness, damping in (t["voigt"] for t in tissues.values())]
    alike = max(times) - min(times) < 0.005
    for time, printed in zip(times, tissues.values(), strict=True):
        law, maxwell = KelvinBoltzmann(*printed["boltzmann"]), Maxwell(*printed["maxwell"])
        yield law.eta
        yield KelvinBoltzmann.create_from_eta(*law.eta).values
        # What k2 and the elastic fit together imply.
        elastic, relaxed = printed["elastic"], law.eta[0]
        stiffness = ", ".join(format_number(k) for k in (law.stiffness, elastic, relaxed))
        yield Recomputed(stiffness, law.k2 > elastic > relaxed, (f"{law.relaxation_time:.3g}",))
        longer = maxwell.relaxation_time > law.relaxation_time
        yield Recomputed(format_number(maxwell.relaxation_time), longer)
        yield Recomputed(format_number(time), alike)
        means = {name: fmean(values) for name, values in printed["rmse"].items()}
        worst, best = max(means, key=means.__getitem__), min(means, key=means.__getitem__)
        found = f"{worst} ({means[worst]:.4f} N m)"
        yield Recomputed(found, worst != printed["worst"], (best, f"{means[best]:.4f}"))


def specimens() -> Iterable[Result]:
    """Recompute the means; the fits themselves rest on records that are not printed."""
    hand = tuple(Elastic(k).convert_to_pivot(ARM).stiffness for k in (1002 - 568, 1002, 1002 + 568))
    fits = read_data("tables.yaml")["specimens"].values()
    return (*(found for printed in fits for found in _specimen_rows(printed)), hand)


def _specimen_rows(printed: dict[str, Any]) -> Iterator[Result]:
    mean = fmean(printed["elastic"])
    yield mean
    yield Elastic(mean).convert_to_pivot(ARM).stiffness
    times = [b / k for k, b in printed["voigt"]]
    yield Recomputed(", ".join(map(format_number, times)), max(times) < PERIOD / 5)
    for eta1, eta2, eta3 in printed["boltzmann"]:
        exists = eta2 / eta3 > eta1
        found = f"no such law: eta2/eta3 = {eta2 / eta3:.4g} N/m"
        if exists:
            law = KelvinBoltzmann.create_from_eta(eta1, eta2, eta3)
            found = ", ".join(format_number(value) for value in law.values)
        yield Recomputed(found, exists == (eta3 < PERIOD / 100))
    # The largest errors are above the root mean square errors.
    errors, forces, rmse = (map(Decimal, printed[key]) for key in ("errors", "forces", "rmse"))
    lower_bounds = [_lower_bound(*pair) for pair in zip(rmse, forces, strict=True)]
    pairs = enumerate(zip(errors, lower_bounds, strict=True), 1)
    violations = [f"{i}" for i, (error, bound) in pairs if error + Decimal("0.5") < bound]
    bounds_text = "at least " + ", ".join(map(str, lower_bounds))
    yield Recomputed(bounds_text, len(violations) == 1, (" and ".join(violations),))


def _lower_bound(rmse: Decimal, force: Decimal) -> Decimal:
    """Return the least quotient in % that two prints leave open, rounded down."""
    error_low, force_high = rmse - _half_digit(rmse), force + _half_digit(force)
    return (100 * error_low / force_high).quantize(Decimal("0.01"), ROUND_FLOOR)


def _half_digit(number: Decimal) -> Decimal:
    """Return half a unit of the last digit."""
    return Decimal((0, (5,), int(number.as_tuple().exponent) - 1))
