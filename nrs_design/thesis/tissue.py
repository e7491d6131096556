"""Chapter 2.5: laws of nose and concha, and what their parameters imply."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from statistics import fmean

from nrs_design.models.contact import KelvinBoltzmann, Maxwell
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


def results() -> Iterable[Found]:
    """Convert the coefficients, and hold the text against the tables."""
    return (found for tissue in BOLTZMANN for found in _results(tissue))


def _results(tissue: str) -> Iterator[Found]:
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
