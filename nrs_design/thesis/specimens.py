"""Chapter 6.1: the silicone specimens."""

from __future__ import annotations

from decimal import ROUND_FLOOR, Decimal
from statistics import fmean

from nrs_design.models.contact import Elastic, KelvinBoltzmann
from nrs_design.thesis.comparison import (
    PrintVerdict,
    ReproducedValue,
    Tolerance,
    claim,
    derived,
    format_number,
    omitted,
    reproduced,
)

# Elastic fits in N/m with their mean, and RMSE in N of elastic, Kelvin-Voigt, Kelvin-Boltzmann.
FITS = {
    "soft": (("768.17", "720.56", "752.69"), "747.14"),
    "stiff": (("1055.4", "1076.6", "1079.6"), "1070.5"),
}


RMSE = {
    "soft": (
        ("0.0969", "0.1586", "0.1491"),
        ("0.0969", "0.1582", "0.1491"),
        ("0.0969", "0.15823", "0.1491"),
    ),
    "stiff": (
        ("0.2135", "0.1764", "0.1519"),
        ("0.2135", "0.1764", "0.1519"),
        ("0.2135", "0.1760", "0.1517"),
    ),
}
LAWS = ("elastic", "Kelvin-Voigt", "Kelvin-Boltzmann")
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
_RECORDS = "the records of force and deflection are shown in figure 6.2 only"
# Thesis 6.2: the compliant controllers, which the laws are for, ran every 0.1 ms on a computer; the
# motion loop at 500 Hz on the processor. How often the records of 6.1 were sampled is not printed.
PERIOD = 1e-4
_BELOW = f"below one period of the compliant controllers ({1e3 * PERIOD:g} ms, 6.2)"
# Largest errors in % of the largest forces in N.
LARGEST = {
    "soft": ((4, 2, 5), (5.1, 5.2, 5.5)),
    "stiff": ((3, 5, 5), (5.1, 5.9, 5.6)),
}
# Lever arm of 6.3.1 in m, and the stiffness there and in 6.4.1.
ARM = 0.24


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute the means; the fits themselves rest on records that are not printed."""
    found = (row for name, (fits, mean) in FITS.items() for row in _specimen(name, fits, mean))
    return (*found, _hand())


def _hand() -> ReproducedValue:
    """Turn the hand of 6.1 at the pivot."""
    return derived(
        "stiffness of a hand at the pivot: least, mean, largest",
        "6.1",
        tuple(Elastic(k).at_pivot(ARM).stiffness for k in (1002 - 568, 1002, 1002 + 568)),
        "N m/rad",
        printed="1002 +- 568 N/m, close to 1070.5 N/m of the stiff specimen",
        right=("24.9984", "57.7152", "90.432"),
        tolerance=Tolerance(1e-5),
        note="At the lever arm of 0.24 m of 6.3.1. The stiff specimen, 61.7 N m/rad, is 6.8 % "
        "above the mean and well inside the range.",
    )


def _specimen(name: str, fits: tuple[str, ...], mean: str) -> tuple[ReproducedValue, ...]:
    return (
        *_means(name, fits, mean),
        _voigt(name),
        *_boltzmann(name),
        *_measured(name),
        _largest(name),
    )


def _largest(name: str) -> ReproducedValue:
    """Hold the largest errors against the root mean square errors, which are below them."""
    errors, forces = LARGEST[name]
    least = [
        _least(Decimal(rmse), Decimal(str(force)))
        for rmse, force in zip(RMSE[name][0], forces, strict=True)
    ]
    below = [f"{i + 1}" for i in range(3) if Decimal(errors[i]) + Decimal("0.5") < least[i]]
    return claim(
        f"largest error of the elastic law over the largest force, {name} specimen",
        "6.1",
        ", ".join(f"{error}" for error in errors),
        "at least " + ", ".join(str(bound) for bound in least),
        "%",
        verdict=PrintVerdict.PRINTED_DIFFERENTLY,
        holds=len(below) == 1,
        note=f"A largest error is no less than the root mean square error of the best fit: "
        f"experiment {' and '.join(below)} contradicts its own, whatever rounding left out of the "
        "prints. The errors themselves need the records.",
        errata=("6.1 largest error",),
    )


def _least(rmse: Decimal, force: Decimal) -> Decimal:
    """Return the least quotient in % that two prints leave open, rounded down."""
    least, most = rmse - _half_digit(rmse), force + _half_digit(force)
    return (100 * least / most).quantize(Decimal("0.01"), ROUND_FLOOR)


def _half_digit(number: Decimal) -> Decimal:
    """Return half a unit of the last digit."""
    return Decimal((0, (5,), int(number.as_tuple().exponent) - 1))


def _voigt(name: str) -> ReproducedValue:
    """Return the time constants of the Kelvin-Voigt fits."""
    times = [b / k for k, b in VOIGT[name]]
    same = [k == eta[0] and b == eta[1] for (k, b), eta in zip(VOIGT[name], ETA[name], strict=True)]
    copied = " In all three experiments k and b are the printed eta1 and eta2." * all(same)
    return derived(
        f"b/k of the Kelvin-Voigt fits, {name} specimen",
        "6.1",
        ", ".join(map(format_number, times)),
        "s",
        printed="; ".join(f"k = {k:g}, b = {b:g}" for k, b in VOIGT[name]),
        holds=max(times) < PERIOD / 5,
        note=f"Well {_BELOW}: the specimen is elastic.{copied}",
    )


def _boltzmann(name: str) -> tuple[ReproducedValue, ...]:
    """Return the elements behind the printed coefficients, where there are any."""
    return tuple(
        _elements(name, experiment, eta) for experiment, eta in enumerate(ETA[name], start=1)
    )


def _elements(name: str, experiment: int, eta: tuple[float, float, float]) -> ReproducedValue:
    eta1, eta2, eta3 = eta
    exists = eta2 / eta3 > eta1
    if exists:
        law = KelvinBoltzmann.from_eta(*eta)
        found = ", ".join(format_number(value) for value in law.values)
        note = f"The relaxation time of {eta3:g} s is far {_BELOW}: the specimen is elastic."
    else:
        found = f"no such law: eta2/eta3 = {eta2 / eta3:.4g} N/m"
        note = "At high frequency it is softer than eta1 at rest: no springs and dampers behave so."
    return derived(
        f"k1, k2, b of the {name} specimen, experiment {experiment}",
        "6.1",
        found,
        "N/m, N/m, N s/m",
        printed=f"eta = {eta1:g}, {eta2:g}, {eta3:g}",
        holds=exists == (eta3 < PERIOD / 100),
        note=note,
    )


def _measured(name: str) -> tuple[ReproducedValue, ...]:
    return tuple(
        omitted(
            f"RMSE of the {law} law, {name} specimen, each experiment",
            "6.1",
            ", ".join(v),
            "N",
            _RECORDS,
        )
        for law, v in zip(LAWS, RMSE[name], strict=True)
    )


def _means(name: str, fits: tuple[str, ...], mean: str) -> tuple[ReproducedValue, ...]:
    return (
        omitted(
            f"elastic fits, {name} specimen",
            "6.1",
            ", ".join(fits),
            "N/m",
            _RECORDS,
        ),
        reproduced(
            f"mean of the fits, {name} specimen",
            "6.1",
            mean,
            fmean(map(float, fits)),
            "N/m",
            Tolerance(5e-5),
        ),
        _at_pivot(name, fits),
    )


def _at_pivot(name: str, fits: tuple[str, ...]) -> ReproducedValue:
    turned = Elastic(fmean(map(float, fits))).at_pivot(ARM)
    printed = {"soft": "43.0356", "stiff": "61.6608"}[name]
    return reproduced(
        f"mean of the fits at the pivot, {name} specimen",
        {"soft": "6.3.1.1", "stiff": "6.4.1"}[name],
        printed,
        turned.stiffness,
        "N m/rad",
        Tolerance(5e-5),
    )
