"""Chapter 6.1: the silicone specimens."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from decimal import ROUND_FLOOR, Decimal
from statistics import fmean

from nrs_design.models.contact import Elastic, KelvinBoltzmann
from nrs_design.thesis.comparison import Found, Recomputed, format_number

# Elastic fits in N/m, and their RMSE in N.
FITS = {"soft": (768.17, 720.56, 752.69), "stiff": (1055.4, 1076.6, 1079.6)}
RMSE = {"soft": ("0.0969", "0.1586", "0.1491"), "stiff": ("0.2135", "0.1764", "0.1519")}
# Kelvin-Boltzmann coefficients eta1 in N/m, eta2 in N s/m and eta3 in s of each experiment.
ETA = {
    "soft": ((768.17, 0.0053, 4.6e-7), (721.33, 0.0067, 7.6e-7), (752.70, 0.0062, 9.9e-7)),
    "stiff": ((1055.4, 0.0101, 3.3e-7), (1077.9, 0.0044, 5.2e-4), (1080.4, 0.0046, 2.5e-4)),
}
# Kelvin-Voigt fits k in N/m and b in N s/m of each experiment.
VOIGT = {
    "soft": ((768.17, 0.0053), (721.33, 0.0067), (752.70, 0.0062)),
    "stiff": ((1055.4, 0.0127), (1076.6, 0.0055), (1079.6, 0.0057)),
}
# Thesis 6.2: the compliant controllers, which the laws are for, ran every 0.1 ms on a computer; the
# motion loop at 500 Hz on the processor. How often the records of 6.1 were sampled is not printed.
PERIOD = 1e-4
# Largest errors in % of the largest forces in N.
LARGEST = {
    "soft": ((4, 2, 5), (5.1, 5.2, 5.5)),
    "stiff": ((3, 5, 5), (5.1, 5.9, 5.6)),
}
# Lever arm of 6.3.1 in m, and the stiffness there and in 6.4.1.
ARM = 0.24


def results() -> Iterable[Found]:
    """Recompute the means; the fits themselves rest on records that are not printed."""
    hand = tuple(Elastic(k).at_pivot(ARM).stiffness for k in (1002 - 568, 1002, 1002 + 568))
    found = [found for name in FITS for found in _results(name)]
    return (*found, hand)


def _results(name: str) -> Iterator[Found]:
    mean = fmean(FITS[name])
    yield mean
    yield Elastic(mean).at_pivot(ARM).stiffness
    times = [b / k for k, b in VOIGT[name]]
    yield Recomputed(", ".join(map(format_number, times)), max(times) < PERIOD / 5)
    for eta1, eta2, eta3 in ETA[name]:
        exists = eta2 / eta3 > eta1
        if exists:
            law = KelvinBoltzmann.from_eta(eta1, eta2, eta3)
            found = ", ".join(format_number(value) for value in law.values)
        else:
            found = f"no such law: eta2/eta3 = {eta2 / eta3:.4g} N/m"
        yield Recomputed(found, exists == (eta3 < PERIOD / 100))
    yield _largest(name)


def _largest(name: str) -> Recomputed:
    """Hold the largest errors against the root mean square errors, which are below them."""
    errors, forces = LARGEST[name]
    least = [
        _least(Decimal(rmse), Decimal(str(force)))
        for rmse, force in zip(RMSE[name], forces, strict=True)
    ]
    below = [f"{i + 1}" for i in range(3) if Decimal(errors[i]) + Decimal("0.5") < least[i]]
    told = "at least " + ", ".join(str(bound) for bound in least)
    return Recomputed(told, len(below) == 1, (" and ".join(below),))


def _least(rmse: Decimal, force: Decimal) -> Decimal:
    """Return the least quotient in % that two prints leave open, rounded down."""
    least, most = rmse - _half_digit(rmse), force + _half_digit(force)
    return (100 * least / most).quantize(Decimal("0.01"), ROUND_FLOOR)


def _half_digit(number: Decimal) -> Decimal:
    """Return half a unit of the last digit."""
    return Decimal((0, (5,), int(number.as_tuple().exponent) - 1))
