"""``nrs-design ros2 export``: impedance controllers for admittance_controller, if proved there."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.ros2.cli.check import Lag, read_lag

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec

RosAxis = Literal["x", "y", "z", "rx", "ry", "rz"]


@command("ros2-export")
def export(
    spec: SpecFile,
    lag: Lag,
    axis: Annotated[
        RosAxis, typer.Option(help="Axis of the control frame that the spec's axis is.")
    ],
    out: Annotated[Path, typer.Option(help="Folder for a file for each controller.")] = Path(
        "reports"
    ),
) -> Answer:
    """Write the impedance controllers of a spec as parameters of admittance_controller.

    The law as that controller computes it, with its force filter, is proved at the rate of the
    spec's `sampling` for every stiffness that is touched; where one controller is refuted (exit
    code 1) or undecided (3), nothing is written. The certificates are written beside the files.

    Example: nrs-design ros2 export mine.nrs.yaml --axis ry --lag '5..20 ms'
    """
    from nrs_design.certificates.ownership import check_certificate, write_certificate
    from nrs_design.output import check_place, write_output
    from nrs_design.pipeline.certification import search_limits
    from nrs_design.pipeline.design import placed
    from nrs_design.pipeline.runs import run_interaction
    from nrs_design.ros2.export import BEGINNING, SEVERITY, export_controllers
    from nrs_design.spec import read_spec

    loaded = read_spec(spec)
    name = loaded.spec.name
    designed = run_interaction(loaded, "has no controllers to export")
    _check_axis(loaded, axis)
    # Files of others are refused before the work.
    files = [out / f"{name}.{one.name}.ros2.yaml" for one in designed.design.controllers]
    for file in files:
        check_place(file, BEGINNING)
        check_certificate(spec, file.with_suffix(".cert.json"))
    with progress(f"exporting {name}"), placed(loaded):
        limits = search_limits(loaded.spec)
        found = list(export_controllers(designed, axis, read_lag(lag), limits))
    worst = max((item.verdict for item in found), key=SEVERITY.index)
    outputs = files if worst == "proved" else []
    # The certificates first: there is never an export without its proofs.
    for file, item in zip(outputs, found, strict=False):
        if item.certificate is not None:
            write_certificate(item.certificate, spec, file.with_suffix(".cert.json"))
        write_output(file, item.text, replaces=BEGINNING)

    def show() -> None:
        if outputs:
            places = ", ".join(map(str, outputs))
            say(f"{name}: PROVED, exported to {places}", verdict="proved")
            return
        for item in found:
            note(f"{name}: {item.controller}: {item.verdict} with admittance_controller")
        note(f"{name}: not exported")

    facts: dict[str, Any] = {
        "spec": name,
        "verdict": worst,
        "controllers": {item.controller: item.verdict for item in found},
        "files": list(map(str, outputs)),
    }
    return Answer(lambda: facts, show, exit_codes.VERDICT_CODES[worst], loud=not outputs)


def _check_axis(loaded: LoadedSpec, axis: str) -> None:
    """Refuse an axis of the control frame that moves in another way than the spec's."""
    from nrs_design.errors import DesignError
    from nrs_design.ros2.law import AXES

    kind = "prismatic" if axis in AXES[:3] else "rotary"
    if getattr(loaded.spec, "axis", kind) != kind:
        raise DesignError(
            f"axis {axis} is no {kind} axis of the control frame",
            path=loaded.path,
            remedy=f"the prismatic ones are {', '.join(AXES[:3])}, the rotary ones "
            f"{', '.join(AXES[3:])}",
        )
