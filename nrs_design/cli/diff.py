"""``nrs-design diff``: compare two specs or certificates."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import detail, progress, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.proof.text import counted

if TYPE_CHECKING:
    from nrs_design.pipeline.comparison import Comparison, Side


@command("diff")
def diff(
    before: Annotated[Path, typer.Argument(metavar="A", help="Spec, or certificate (.json).")],
    after: Annotated[Path, typer.Argument(metavar="B", help="Spec, or certificate (.json).")],
) -> Answer:
    """Compare two specs or certificates: what they say, gains, margins, verdicts, assumptions.

    Specs are designed and certified afresh. Certificates are re-checked by themselves; they have no
    margins, and do not repeat their specs, so a comparison with one leaves both out and says so.

    Exit code 0: no difference. 1: there are some.

    Example: nrs-design diff specs/neuroboscope/soft-tissue.nrs.yaml reports/soft-tissue.cert.json
    """
    from nrs_design.pipeline.comparison import compare

    with progress("comparing") as step:
        found = compare(before, after, step)
    code = exit_codes.unless(found.differences)
    return Answer(lambda: _summary(found), lambda: _print(found), code)


def _summary(comparison: Comparison) -> dict[str, Any]:
    return {
        "a": _side(comparison.before),
        "b": _side(comparison.after),
        "differences": [
            {"part": str(item.part), "what": item.what, "a": item.before, "b": item.after}
            for item in comparison.differences
        ],
        "same": list(map(str, comparison.same)),
        "not_compared": list(map(str, comparison.not_compared)),
        "remarks": list(comparison.remarks),
    }


def _side(side: Side) -> dict[str, str]:
    return {"file": str(side.path), "name": side.name}


def _print(comparison: Comparison) -> None:
    say(f"A: {comparison.before.name} ({comparison.before.path})")
    say(f"B: {comparison.after.name} ({comparison.after.path})")
    for part in comparison.compared:
        items = [item for item in comparison.differences if item.part is part]
        rows = [
            [item.what, item.before or "-", item.after or "-"] for item in items if not item.is_text
        ]
        if rows:
            print_table(str(part), ["", "A", "B"], rows)
        texts = [item for item in items if item.is_text]
        for item in texts:
            for side, text in (("A", item.before), ("B", item.after)):
                if text is not None:
                    detail(f"{part}, {side}: {text}")
        if texts and not wants_details():
            differ = "differs" if len(texts) == 1 else "differ"
            say(f"{part}: {counted(len(texts), 'text')} {differ} (-v shows them)")
    if comparison.same:
        say(f"the same: {', '.join(comparison.same)}")
    for remark in comparison.remarks:
        say(remark)
