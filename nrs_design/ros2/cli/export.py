"""``nrs-design ros2 export``: impedance controllers for admittance_controller, if proved there."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.ros2.cli.options import Lag, read_lag

if TYPE_CHECKING:
    from nrs_design.ros2.export import RosExport


class RosAxis(StrEnum):
    """Rotations of the control frame."""

    RX = "rx"
    RY = "ry"
    RZ = "rz"


@command("ros2-export")
def export(
    spec: SpecFile,
    axis: Annotated[
        RosAxis, typer.Option(help="Axis of the control frame about which the spec's axis turns.")
    ],
    lag: Lag,
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
    from nrs_design.pipeline import placed, run_interaction, search_limits
    from nrs_design.ros2.export import export_controllers, not_for_ranges
    from nrs_design.spec import read_spec

    loaded = read_spec(spec)
    designed = run_interaction(loaded, "has no controllers to export")
    name = loaded.spec.name
    files = {c.name: out / f"{name}.{c.name}.ros2.yaml" for c in designed.design.controllers}
    _check(spec, files)
    with progress(f"exporting {name}"), placed(loaded):
        found = list(export_controllers(designed, axis, read_lag(lag), search_limits(loaded.spec)))
    worst = max((item.verdict for item in found), key=_SEVERITY.index)
    written = []
    if worst == "proved":
        for item in found:
            written.append(str(files[item.controller]))
            _write(spec, files[item.controller], item)

    def show() -> None:
        if not written:
            for item in found:
                note(f"{name}: {item.controller}: {item.verdict} with admittance_controller")
            note(f"{name}: not exported")
            return
        say(f"{name}: PROVED, exported to {', '.join(written)}", verdict="proved")
        for item in found:
            if item.ranged:
                say(f"  {item.controller}: outside the proof: {not_for_ranges(item.ranged)}")

    return Answer(
        lambda: _summary(name, worst, found, written),
        show,
        exit_codes.OF_VERDICT[worst],
        loud=not written,
    )


_SEVERITY = ("proved", "inconclusive", "refuted")


def _proof(file: Path) -> Path:
    return file.with_suffix(".cert.json")


def _check(spec: Path, files: dict[str, Path]) -> None:
    """Refuse what must not be overwritten, before the work."""
    from nrs_design.output import check_place
    from nrs_design.ownership import check_certificate
    from nrs_design.ros2.export import BEGINNING

    for file in files.values():
        check_place(file, BEGINNING)
        check_certificate(spec, _proof(file))


def _write(spec: Path, file: Path, item: RosExport) -> None:
    """Write the certificate first: there is never an export without its proof."""
    from nrs_design.certificates.certificate import dump
    from nrs_design.output import CERTIFICATE, write_output
    from nrs_design.ownership import origin_of
    from nrs_design.ros2.export import BEGINNING

    assert item.certificate is not None, "proved"
    proof = _proof(file)
    write_output(proof, dump(item.certificate, origin_of(spec, proof)), replaces=CERTIFICATE)
    write_output(file, item.text, replaces=BEGINNING)


def _summary(name: str, worst: str, found: list[RosExport], written: list[str]) -> dict[str, Any]:
    return {
        "spec": name,
        "verdict": worst,
        "controllers": {item.controller: item.verdict for item in found},
        "ranges_not_proved": {i.controller: list(i.ranged) for i in found if i.ranged},
        "files": written,
    }
