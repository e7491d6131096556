"""Chapter 2.5: laws of nose and concha, and what their parameters imply."""

from __future__ import annotations

from collections.abc import Mapping
from statistics import fmean

from nrs_design.models.contact import KelvinBoltzmann, Maxwell
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
# Computed once from the printed coefficients, with all their digits.
ETA = {
    "nose": ("0.18795", "19.06169", "19.61079"),
    "concha": ("0.41833", "26.59867", "8.05288"),
}
_TABLE = {"nose": "table 2.4", "concha": "table 2.5"}
_RECORD = "The length of the records is not printed."


def rows() -> tuple[ReproducedValue, ...]:
    """Convert the coefficients, and hold the text against the tables."""
    return tuple(
        row
        for tissue in BOLTZMANN
        for row in (
            _eta(tissue),
            _round_trip(tissue),
            _memory(tissue),
            _maxwell(tissue),
            _voigt(tissue),
            _worst(tissue),
            *_measured(tissue),
        )
    )


def _eta(tissue: str) -> ReproducedValue:
    law = BOLTZMANN[tissue]
    return derived(
        f"eta1, eta2, eta3 of the {tissue}",
        _TABLE[tissue],
        law.eta,
        "N m/rad, N m s/rad, s",
        printed=f"k1 = {law.k1:g}, k2 = {law.k2:g}, b = {law.b:g}",
        tolerance=Tolerance(3e-5),
        right=ETA[tissue],
        note="The thesis prints the elements only; eta3 is the relaxation time.",
    )


def _round_trip(tissue: str) -> ReproducedValue:
    law = BOLTZMANN[tissue]
    back = KelvinBoltzmann.from_eta(*law.eta)
    printed = (f"{law.k1:g}", f"{law.k2:g}", f"{law.b:g}")
    return reproduced(
        f"k1, k2, b of the {tissue}, back from eta",
        _TABLE[tissue],
        printed,
        back.values,
        "N m/rad, N m/rad, N m s/rad",
        Tolerance(1e-9),
    )


def _memory(tissue: str) -> ReproducedValue:
    """Show what k2 and the elastic fit together imply."""
    law, elastic = BOLTZMANN[tissue], ELASTIC[tissue]
    relaxed = law.eta[0]
    return derived(
        f"stiffness of the {tissue}: at once, elastic fit, relaxed",
        _TABLE[tissue],
        ", ".join(format_number(k) for k in (law.stiffness, elastic, relaxed)),
        "N m/rad",
        printed=f"k2 = {law.k2:g}, elastic {elastic:g}",
        holds=law.k2 > elastic > relaxed,
        note=f"The elastic fit is near the relaxed end, so the records must be much longer than "
        f"the relaxation time of {law.relaxation_time:.3g} s, if time is in seconds. {_RECORD}",
        errata=("table 2.4 units",),
    )


def _maxwell(tissue: str) -> ReproducedValue:
    law = MAXWELL[tissue]
    return derived(
        f"relaxation time b/k of the Maxwell {tissue}",
        _TABLE[tissue],
        format_number(law.relaxation_time),
        "s",
        printed=f"k = {law.k:g}, b = {law.b:g}",
        holds=law.relaxation_time > BOLTZMANN[tissue].relaxation_time,
        note=f"Longer than that of the Kelvin-Boltzmann law on the same records. {_RECORD}",
    )


def _voigt(tissue: str) -> ReproducedValue:
    k, b = VOIGT[tissue]
    others = [damping / stiffness for stiffness, damping in VOIGT.values()]
    return derived(
        f"b/k of the Kelvin-Voigt {tissue}",
        _TABLE[tissue],
        format_number(b / k),
        "s",
        printed=f"k = {k:g}, b = {b:g}",
        holds=max(others) - min(others) < 0.005,
        note="The same for both tissues, which looks like a bound or a start value of the search.",
        errata=("table 2.4 b/k",),
    )


def _worst(tissue: str) -> ReproducedValue:
    means = {law: fmean(values) for law, values in RMSE[tissue].items()}
    worst, best = max(means, key=means.__getitem__), min(means, key=means.__getitem__)
    said = {"nose": "Maxwell", "concha": "Kelvin-Voigt"}[tissue]
    return claim(
        f"law with the largest mean RMSE, {tissue}",
        "2.5",
        said,
        f"{worst} ({means[worst]:.4f} N m)",
        verdict=PrintVerdict.PRINTED_DIFFERENTLY,
        errata=("2.5",),
        holds=worst != said,
        note=f"From {_TABLE[tissue]}; the least mean is that of {best} ({means[best]:.4f} N m).",
    )


def _measured(tissue: str) -> tuple[ReproducedValue, ...]:
    return tuple(
        omitted(
            f"RMSE of the {law} {tissue}, each experiment",
            _TABLE[tissue],
            ", ".join(f"{value:.4f}" for value in values),
            "N m",
            "it is a fit to records that are not printed",
        )
        for law, values in RMSE[tissue].items()
    )
