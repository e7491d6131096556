"""Chapter 6.1: the silicone specimens."""

from __future__ import annotations

from statistics import fmean

from nrs_design.reproduction.row import Row, Tolerance, omitted, reproduced

FITS = {
    "soft": (("768.17", "720.56", "752.69"), "747.14"),
    "stiff": (("1055.4", "1076.6", "1079.6"), "1070.5"),
}


def rows() -> tuple[Row, ...]:
    """Recompute the means; the fits themselves rest on records that are not printed."""
    return tuple(row for name, (fits, mean) in FITS.items() for row in _specimen(name, fits, mean))


def _specimen(name: str, fits: tuple[str, ...], mean: str) -> tuple[Row, Row]:
    return (
        omitted(
            f"elastic fits, {name} specimen",
            "6.1",
            ", ".join(fits),
            "N/m",
            "The records of force and deflection are shown in figure 6.2 only.",
        ),
        reproduced(
            f"mean of the fits, {name} specimen",
            "6.1",
            mean,
            fmean(map(float, fits)),
            "N/m",
            Tolerance(5e-5),
        ),
    )
