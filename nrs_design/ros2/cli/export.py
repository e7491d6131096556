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
    from collections.abc import Mapping

    from nrs_design.pipeline.design import Designed
    from nrs_design.ros2.export import RosExport
    from nrs_design.spec import LoadedSpec


RosAxis = Literal["x", "y", "z", "rx", "ry", "rz"]


@command("ros2-export")
def export(
    spec: SpecFile,
    lag: Lag,
    axis: Annotated[
        RosAxis | None,
        typer.Option(
            help="Axis of the control frame that the spec's axis is; a file with several axes "
            "names them x, y, z, rx, ry, rz itself."
        ),
    ] = None,
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
    from nrs_design.pipeline.certification import search_limits
    from nrs_design.pipeline.design import placed
    from nrs_design.pipeline.runs import run_interaction
    from nrs_design.ros2.export import SEVERITY, export_controllers

    axes = _axes_of(spec, axis)
    designs = {
        name: run_interaction(loaded, "has no controllers to export")
        for name, loaded in axes.items()
    }
    loaded = next(iter(axes.values()))
    name = loaded.spec.name if axis is not None else spec.name.partition(".")[0]
    _check_folder(spec, out, name, designs)
    with progress(f"exporting {name}"), placed(loaded):
        found = list(export_controllers(designs, read_lag(lag), search_limits(loaded.spec)))
    worst = max((item.verdict for item in found), key=SEVERITY.index)
    written = []
    if worst == "proved":
        for item in found:
            file = out / f"{name}.{item.controller}.ros2.yaml"
            written.append(str(file))
            _write(axes, file, item)

    def show() -> None:
        if not written:
            for item in found:
                note(f"{name}: {item.controller}: {item.verdict} with admittance_controller")
            note(f"{name}: not exported")
            return
        say(f"{name}: PROVED, exported to {', '.join(written)}", verdict="proved")

    return Answer(
        lambda: _summary(name, worst, found, written),
        show,
        exit_codes.OF_VERDICT[worst],
        loud=not written,
    )


def _axes_of(spec: Path, axis: RosAxis | None) -> dict[str, LoadedSpec]:
    """Return the specs of all axes by the axis of the control frame that each is."""
    from nrs_design.errors import DesignError
    from nrs_design.ros2.law import AXES
    from nrs_design.spec.load import read_axes

    loaded = read_axes(spec)
    if axis is None and len(loaded) == 1 and loaded[0].path == spec:
        raise typer.BadParameter("name the axis that the spec is of", param_hint="--axis")
    if axis is not None and loaded[0].path != spec:
        raise typer.BadParameter("the file names its axes itself", param_hint="--axis")
    names = [axis] if axis else [str(item.path).rpartition("#")[2] for item in loaded]
    for name, item in zip(names, loaded, strict=True):
        kind = "prismatic" if name in AXES[:3] else "rotary"
        if name not in AXES or getattr(item.spec, "axis", kind) != kind:
            raise DesignError(
                f"axis {name} is no {kind} axis of the control frame",
                path=item.path,
                remedy=f"the prismatic ones are {', '.join(AXES[:3])}, the rotary ones "
                f"{', '.join(AXES[3:])}",
            )
    return dict(zip(names, loaded, strict=True))


def _proof(file: Path, axis: str, count: int) -> Path:
    """Return the certificate beside a parameter file: one for each axis, if there are several."""
    stem = str(file).removesuffix(".ros2.yaml")
    return Path(f"{stem}.{axis}.ros2.cert.json" if count > 1 else f"{stem}.ros2.cert.json")


def _check_folder(spec: Path, out: Path, name: str, designs: Mapping[str, Designed]) -> None:
    """Refuse what must not be overwritten, before the work."""
    from nrs_design.output import check_place
    from nrs_design.ownership import check_certificate
    from nrs_design.ros2.export import BEGINNING

    for designed in designs.values():
        for controller in designed.design.controllers:
            file = out / f"{name}.{controller.name}.ros2.yaml"
            check_place(file, BEGINNING)
            for axis in designs:
                check_certificate(spec, _proof(file, axis, len(designs)))


def _write(axes: Mapping[str, LoadedSpec], file: Path, item: RosExport) -> None:
    """Write the certificates first: there is never an export without its proofs."""
    from nrs_design.output import write_output
    from nrs_design.ownership import write_certificate
    from nrs_design.ros2.export import BEGINNING

    for axis, certificate in item.certificates.items():
        write_certificate(certificate, axes[axis].path, _proof(file, axis, len(axes)))
    write_output(file, item.text, replaces=BEGINNING)


def _summary(name: str, worst: str, found: list[RosExport], written: list[str]) -> dict[str, Any]:
    return {
        "spec": name,
        "verdict": worst,
        "controllers": {item.controller: item.verdict for item in found},
        "files": written,
    }
