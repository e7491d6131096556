"""``nrs-design robot correction``: from the simplified to the full torque."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note
from nrs_design.cli.tables import print_table
from nrs_design.robot.cli.options import lists

if TYPE_CHECKING:
    from nrs_design.robot.models.correction import Correction, Sine, TiltTable


@command("robot-correction")
def correction(
    spec: SpecFile,
    table: Annotated[
        Path | None,
        typer.Option(
            "--table", metavar="FILE", help="Write the coefficients by tilt, for the controller."
        ),
    ] = None,
) -> Answer:
    """Compute correction coefficients over trajectories and over the tilt of the base.

    Example: nrs-design robot correction specs/robots/neuroboscope.nrs.yaml --table correction.csv
    """
    from nrs_design.output import TABLE, check_place, write_output
    from nrs_design.robot.models.correction import (
        DEPTH_SINES,
        TABLE_3_5,
        correction_coefficients,
        thesis_tilts,
        tilt_tables,
        to_csv,
    )
    from nrs_design.robot.pipeline import run_robot

    if table is not None:
        check_place(table, TABLE)
    loaded, _, robot = run_robot(spec)
    rows = [(sine, correction_coefficients(robot, sine)) for sine in TABLE_3_5]
    (tilts,) = tilt_tables(robot, thesis_tilts(), DEPTH_SINES)
    files: list[str] = []
    if table is not None:
        write_output(table, to_csv(tilts), replaces=TABLE)
        files.append(str(table))
        note(f"table written to {table}")
    facts = loaded.facts | _document(rows, tilts) | {"files": files}
    return Answer(lambda: facts, lambda: _print(rows, tilts))


def _document(rows: list[tuple[Sine, Correction]], tilts: TiltTable) -> dict[str, Any]:
    import numpy as np

    return {
        "trajectories": [
            {
                "phi": sine.phi,
                "psi": sine.psi,
                "d": list(sine.d),
                **lists(
                    found, "mean_ratio", "least_squares", "mean_ratio_error", "least_squares_error"
                ),
            }
            for sine, found in rows
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


def _print(rows: list[tuple[Sine, Correction]], tilts: TiltTable) -> None:
    import numpy as np

    print_table(
        "along slow sines, phi and psi in rad",
        ["phi", "psi", "d [mm]", "K1", "K2", "K3", "K1 ls", "K2 ls", "K3 ls"],
        [
            [
                f"{sine.phi:g}",
                f"{sine.psi:g}",
                f"{1e3 * sine.d[0]:.0f} - {1e3 * sine.d[1]:.0f}",
                *(f"{k:.4f}" for k in (*found.mean_ratio, *found.least_squares)),
            ]
            for sine, found in rows
        ],
    )
    print_table(
        "over the tilt of the base, every 5 deg",
        ["theta4 [deg]", "K1", "K2", "K3", "K1 ls", "K2 ls", "K3 ls"],
        [
            [f"{np.degrees(tilt):.1f}", *(f"{k:.4f}" for k in (*ratio, *squares))]
            for tilt, ratio, squares in zip(
                tilts.tilt[::5], tilts.mean_ratio[::5], tilts.least_squares[::5], strict=True
            )
        ],
    )
