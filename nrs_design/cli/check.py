"""``nrs-design check``: validate specs and print what was understood."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.errors import error_summary, print_error
from nrs_design.cli.printing import note, say, wants_details, wants_json, wants_text
from nrs_design.cli.tables import print_table
from nrs_design.errors import NrsDesignError
from nrs_design.proof.text import counted


@command("check")
def check(
    specs: Annotated[list[Path], typer.Argument(metavar="SPEC...", help="Spec files.")],
) -> Answer:
    """Validate specs; with -v, print what was understood, as written and in SI units.

    Example: nrs-design check specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.gating.find_specs import axes_or_whole

    results: list[dict[str, Any]] = []
    for path in [axis for spec in specs for axis in axes_or_whole(spec)]:
        try:
            results.append(_understood(path))
        except NrsDesignError as error:
            results.append({"valid": False, **error_summary(error), "path": str(path)})
            if not wants_json():
                print_error(error)
            continue
        if wants_text():
            _print(results[-1])
            for text in results[-1]["warnings"]:
                note(f"warning: {text}")
    valid = all(result["valid"] for result in results)
    return Answer(lambda: {"specs": results}, code=exit_codes.PROVED if valid else exit_codes.USAGE)


def _understood(path: Path) -> dict[str, Any]:
    from nrs_design.spec import doubt_spec
    from nrs_design.spec.describe import describe

    loaded = take_spec(path)
    return {
        "path": str(path),
        "valid": True,
        "kind": loaded.spec.kind,
        "name": loaded.spec.name,
        "spec_sha256": loaded.sha256,
        "values": [
            {"name": row.name, "written": row.written, "si": row.value, "unit": row.unit}
            for row in describe(loaded.spec)
        ],
        "warnings": [
            f"{path}:{place.line}:{place.column}: {doubt}"
            for doubt in doubt_spec(loaded.spec)
            for place in [loaded.place(*doubt.at)]
        ],
    }


def _print(result: dict[str, Any]) -> None:
    title = f"{result['path']}: ok ({result['kind']}, {counted(len(result['values']), 'field')}"
    if not wants_details():
        say(f"{title}; -v lists them)")
        return
    print_table(
        f"{title})",
        ["field", "as written", "SI value", "unit"],
        [[v["name"], v["written"], v["si"], v["unit"]] for v in result["values"]],
    )
