"""Chapter 4: tracking errors that were measured on the robot."""

from __future__ import annotations

from nrs_design.reproduction.row import Row, hardware_only

# Controller, tables, and RMSE of phi, psi (deg) and d (mm) where d, phi or psi moves.
MEASURED = (
    (
        "computed torque",
        ("4.2", "4.3", "4.4"),
        ("0.0515, 0.1080, 0.2417", "0.8216, 0.0626, 0.1783", "0.0511, 0.7248, 0.8359"),
    ),
    (
        "independent joints",
        ("4.5", "4.6", "4.7"),
        ("0.0124, 0.0555, 0.5122", "0.0624, 0.0279, 0.1261", "0.0157, 0.0488, 0.2224"),
    ),
    (
        "balanced robot",
        ("4.8", "4.9", "4.10"),
        ("0.0449, 0.0680, 0.6263", "0.2139, 0.0782, 0.5086", "0.0690, 0.2347, 0.5827"),
    ),
)


def rows() -> tuple[Row, ...]:
    """List the root mean square errors of tables 4.2 to 4.10."""
    return tuple(
        hardware_only(
            f"tracking RMSE of phi, psi, d; {controller}, {moved} moves",
            f"table {table}",
            printed,
            "deg, deg, mm",
        )
        for controller, tables, prints in MEASURED
        for moved, table, printed in zip(("d", "phi", "psi"), tables, prints, strict=True)
    )
