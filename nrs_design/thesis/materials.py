"""Chapters 2.5 and 6.1: laws of nose and concha, and the silicone specimens."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from decimal import ROUND_FLOOR, Decimal
from statistics import fmean

from nrs_design.models.contact import Elastic, KelvinBoltzmann, Maxwell
from nrs_design.thesis.comparison import Found, Recomputed, format_number

# Thesis tables 2.4 and 2.5: mean coefficients in N m/rad and N m s/rad, and RMSE in N m.
BOLTZMANN = {
    "nose": KelvinBoltzmann(k1=0.233, k2=0.972, b=23.631),
    "concha": KelvinBoltzmann(k1=0.479, k2=3.303, b=30.456),
}
MAXWELL = {"nose": Maxwell(k=1.129, b=120.233), "concha": Maxwell(k=3.476, b=137.860)}
VOIGT = {"nose": (0.205, 0.341), "concha": (0.574, 0.957)}
ELASTIC = {"nose": 0.207, "concha": 0.589}
RMSE: Mapping[str, Mapping[str, tuple[float, ...]]] = {
    "nose": {
        "Kelvin-Boltzmann": (0.0216, 0.0165, 0.0062, 0.0111),
        "Kelvin-Voigt": (0.0235, 0.0156, 0.0062, 0.0108),
        "elastic": (0.0237, 0.0155, 0.0062, 0.0114),
        "Maxwell": (0.0217, 0.0135, 0.0068, 0.0099),
        "Hunt-Crossley": (0.0264, 0.0132, 0.0064, 0.0096),
    },
    "concha": {
        "Kelvin-Boltzmann": (0.0157, 0.0085, 0.0128, 0.0055, 0.0080),
        "Kelvin-Voigt": (0.0198, 0.0114, 0.0106, 0.0064, 0.0072),
        "elastic": (0.0206, 0.0110, 0.0104, 0.0066, 0.0068),
        "Maxwell": (0.0334, 0.0111, 0.0107, 0.0083, 0.0098),
        "Hunt-Crossley": (0.0237, 0.0050, 0.0117, 0.0068, 0.0048),
    },
}


def tissue() -> Iterable[Found]:
    """Convert the coefficients, and hold the text against the tables."""
    return (found for tissue in BOLTZMANN for found in _of_tissue(tissue))


def _of_tissue(tissue: str) -> Iterator[Found]:
    law, maxwell = BOLTZMANN[tissue], MAXWELL[tissue]
    yield law.eta
    yield KelvinBoltzmann.from_eta(*law.eta).values
    # What k2 and the elastic fit together imply.
    elastic, relaxed = ELASTIC[tissue], law.eta[0]
    stiffness = ", ".join(format_number(k) for k in (law.stiffness, elastic, relaxed))
    yield Recomputed(stiffness, law.k2 > elastic > relaxed, (f"{law.relaxation_time:.3g}",))
    longer = maxwell.relaxation_time > law.relaxation_time
    yield Recomputed(format_number(maxwell.relaxation_time), longer)
    times = [damping / stiffness for stiffness, damping in VOIGT.values()]
    k, b = VOIGT[tissue]
    yield Recomputed(format_number(b / k), max(times) - min(times) < 0.005)
    means = {law: fmean(values) for law, values in RMSE[tissue].items()}
    worst, best = max(means, key=means.__getitem__), min(means, key=means.__getitem__)
    said = {"nose": "Maxwell", "concha": "Kelvin-Voigt"}[tissue]
    found = f"{worst} ({means[worst]:.4f} N m)"
    yield Recomputed(found, worst != said, (best, f"{means[best]:.4f}"))


# Elastic fits in N/m, and their ERRORS in N.
FITS = {"soft": (768.17, 720.56, 752.69), "stiff": (1055.4, 1076.6, 1079.6)}
ERRORS = {"soft": ("0.0969", "0.1586", "0.1491"), "stiff": ("0.2135", "0.1764", "0.1519")}
# Kelvin-Boltzmann coefficients eta1 in N/m, eta2 in N s/m and eta3 in s of each experiment.
ETA = {
    "soft": ((768.17, 0.0053, 4.6e-7), (721.33, 0.0067, 7.6e-7), (752.70, 0.0062, 9.9e-7)),
    "stiff": ((1055.4, 0.0101, 3.3e-7), (1077.9, 0.0044, 5.2e-4), (1080.4, 0.0046, 2.5e-4)),
}
# Kelvin-Voigt fits k in N/m and b in N s/m of each experiment.
VOIGT_FITS = {
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


def specimens() -> Iterable[Found]:
    """Recompute the means; the fits themselves rest on records that are not printed."""
    hand = tuple(Elastic(k).at_pivot(ARM).stiffness for k in (1002 - 568, 1002, 1002 + 568))
    found = [found for name in FITS for found in _of_specimen(name)]
    return (*found, hand)


def _of_specimen(name: str) -> Iterator[Found]:
    mean = fmean(FITS[name])
    yield mean
    yield Elastic(mean).at_pivot(ARM).stiffness
    times = [b / k for k, b in VOIGT_FITS[name]]
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
        for rmse, force in zip(ERRORS[name], forces, strict=True)
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
