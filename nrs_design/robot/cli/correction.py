"""``nrs-design robot correction``: from the simplified to the full torque."""

from __future__ import annotations

from typing import Any

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.tables import print_table
from nrs_design.robot.cli.options import lists

_COEFFICIENTS = ("K1", "K2", "K3", "K1 ls", "K2 ls", "K3 ls")


@command("robot-correction")
def correction(spec: SpecFile) -> Answer:
    """Compute correction coefficients over trajectories and over the tilt of the base.

    Example: nrs-design robot correction specs/robots/neuroboscope.nrs.yaml --json
    """
    import numpy as np

    from nrs_design.robot.models.correction import (
        DEPTH_SINES,
        TABLE_3_5,
        correction_coefficients,
        thesis_tilts,
        tilt_table,
    )
    from nrs_design.robot.pipeline import run_robot

    loaded, _, robot = run_robot(spec)
    tilts = tilt_table(robot, thesis_tilts(), DEPTH_SINES)
    errors = ("mean_ratio_error", "least_squares_error")
    content: dict[str, Any] = {
        "trajectories": [
            {"phi": sine.phi, "psi": sine.psi, "d": list(sine.d)}
            | lists(correction_coefficients(robot, sine), "mean_ratio", "least_squares", *errors)
            for sine in TABLE_3_5
        ],
        "tilts": [
            {"theta4_deg": float(tilt), "mean_ratio": ratio, "least_squares": squares}
            for tilt, ratio, squares in zip(
                np.degrees(tilts.tilt),
                tilts.mean_ratio.tolist(),
                tilts.least_squares.tolist(),
                strict=True,
            )
        ],
        "units": {"angles": "rad", "d": "m", "error": "N*m"},
    }
    return Answer(lambda: loaded.facts | content, lambda: _print(content))


def _print(content: dict[str, Any]) -> None:
    print_table(
        "along slow sines, phi and psi in rad",
        ["phi", "psi", "d [mm]", *_COEFFICIENTS],
        [
            [
                *(f"{row[name]:g}" for name in ("phi", "psi")),
                " - ".join(f"{1e3 * depth:.0f}" for depth in row["d"]),
                *_texts(row),
            ]
            for row in content["trajectories"]
        ],
    )
    print_table(
        "over the tilt of the base, every 5 deg",
        ["theta4 [deg]", *_COEFFICIENTS],
        [[f"{row['theta4_deg']:.1f}", *_texts(row)] for row in content["tilts"][::5]],
    )


def _texts(row: dict[str, Any]) -> list[str]:
    return [f"{k:.4f}" for k in (*row["mean_ratio"], *row["least_squares"])]
