"""``nrs-design map``: what is proved, refuted or undecided over fields of a spec."""

from __future__ import annotations

import csv
import io
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command, spec_facts
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.reading import take_spec

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec
    from nrs_design.sweeps.tile_map import TileMap

SIGNS = {"proved": "#", "refuted": "x", "inconclusive": "."}
# A wider map is drawn in files only.
WIDEST = 90
# Letters of the id of a certificate that its file is named by.
SHORT = 16


@command("map")
def map(
    spec: SpecFile,
    over: Annotated[
        list[str],
        typer.Option(
            metavar="PATH=VALUES",
            help="A field of the spec and what it is cut into: '1..250/16 N*m/rad' is 16 "
            "intervals, 0..10 are whole numbers. Up to three times.",
        ),
    ],
    figure: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw one or two fields as a PNG image.")
    ] = None,
    table: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Write a row for every tile.")
    ] = None,
    certificates: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Write every certificate, and the spec it is about."),
    ] = None,
) -> Answer:
    """Decide a spec over one to three of its fields: every tile is proved, refuted or undecided.

    Nothing is interpolated: a proof is for all values of its tiles at once, however fast they
    change, and a refutation has a witness. Of a field that takes a range, tiles are intervals; of
    one that is a range, such as sampling.delay: [0, 1], its upper end takes each value; any other
    takes each value by itself. The exit code is 0 if all tiles are proved, 1 if one is refuted.

    Example: nrs-design map specs/neuroboscope/soft-tissue-sampled.nrs.yaml
    --over 'environments.soft.stiffness=100..1700/8 N/m' --over sampling.delay=0..3
    """
    from nrs_design.cli.exit_codes import OF_VERDICT, worst
    from nrs_design.output import MAP, PNG, check_place, write_output
    from nrs_design.pipeline import run_design
    from nrs_design.sweeps.tile_map import run_tile_map
    from nrs_design.sweeps.tiles import read_tiles

    for path, kind in ((figure, PNG), (table, MAP)):
        if path is not None:
            check_place(path, kind)
    loaded = take_spec(spec)
    grid = read_tiles(loaded, spec, over)
    with progress(f"map of {loaded.spec.name}") as step:
        found = run_tile_map(grid, run_design(loaded), step)
    if figure is not None:
        from nrs_design.reporting.images import to_png
        from nrs_design.sweeps.tile_figure import draw_tile_map

        write_output(figure, to_png(draw_tile_map(found)), replaces=PNG)
        note(f"figure written to {figure}")
    if table is not None:
        write_output(table, _table(found), replaces=MAP)
        note(f"table written to {table}")
    if certificates is not None:
        _write_certificates(found, certificates)
    codes = {OF_VERDICT[str(tile.verdict)] for tile in found.tiles.values()}
    return Answer(partial(_facts, loaded, found), partial(_print, loaded, found), worst(codes))


def _facts(loaded: LoadedSpec, found: TileMap) -> dict[str, Any]:
    return {
        **spec_facts(loaded),
        "fields": [
            {
                "path": field.field.path,
                "cut": str(field.cut),
                "unit": field.unit,
                "values": list(field.values),
            }
            for field in found.grid.fields
        ],
        "keeps_gains": found.grid.keeps_gains,
        "tiles": [
            {
                "at": [field.text(k) for field, k in zip(found.grid.fields, place, strict=True)],
                "verdict": str(tile.verdict),
                "certificate": tile.certificate,
                "refuted_in": tile.refuted_in,
                "wrong": tile.wrong or None,
            }
            for place, tile in found.tiles.items()
        ],
        "certificates": [
            {"id": certificate.id, "box": [list(span) for span in box]}
            for certificate, box in zip(found.certificates, found.boxes, strict=True)
        ],
        "proofs_tried": found.proofs,
        "witnesses_sought": found.witnesses,
    }


def _print(loaded: LoadedSpec, found: TileMap) -> None:
    from nrs_design.certificates.certificate import Verdict

    counts = [found.count(one) for one in (Verdict.PROVED, Verdict.REFUTED, Verdict.INCONCLUSIVE)]
    say(
        f"{loaded.spec.name}: {len(found.tiles)} tiles: {counts[0]} proved, {counts[1]} refuted, "
        f"{counts[2]} undecided; {found.proofs} proofs and {found.witnesses} witnesses tried"
    )
    fields = found.grid.fields
    if len(fields) == 2 and fields[0].count <= WIDEST:
        _draw(found)
    elif len(fields) == 1:
        for place, tile in found.tiles.items():
            say(f"  {fields[0].text(place[0])}: {tile.verdict}")
    else:
        say("--figure, --csv or --json have the tiles")
    wrong = next((tile.wrong for tile in found.tiles.values() if tile.wrong), None)
    if wrong is not None:
        note(f"warning: some tiles make no system: {wrong}")
    where = next((tile.refuted_in for tile in found.tiles.values() if tile.refuted_in), None)
    if where is not None:
        say(f"  x: refuted {where}, for some of them; where contact may be lost, these are open")
    if not found.grid.keeps_gains:
        say("Gains are designed anew in every tile.")


def _draw(found: TileMap) -> None:
    """Draw the first field across, and the second one up."""
    across, up = found.grid.fields
    width = max(len(up.text(k)) for k in range(up.count))
    for level in reversed(range(up.count)):
        signs = (SIGNS[str(found.tiles[k, level].verdict)] for k in range(across.count))
        say(f"  {up.text(level):>{width}} |{''.join(signs)}")
    say(f"  {'':>{width}} {across.text(0)} to {across.text(across.count - 1)}")
    say(f"  # proved, x refuted, . undecided; up: {up.field.path}, across: {across.field.path}")


def _table(found: TileMap) -> str:
    written = io.StringIO()
    rows = csv.writer(written, lineterminator="\n")
    paths = (field.field.path for field in found.grid.fields)
    rows.writerow(["verdict", "certificate", "refuted_in", *paths])
    for place, tile in found.tiles.items():
        certificate = None if tile.certificate is None else found.certificates[tile.certificate].id
        at = [field.text(k) for field, k in zip(found.grid.fields, place, strict=True)]
        rows.writerow([str(tile.verdict), certificate, tile.refuted_in, *at])
    return written.getvalue()


def _write_certificates(found: TileMap, folder: Path) -> None:
    """Write every certificate, and the spec that it is about, all or none."""
    from nrs_design.certificates.certificate import dump
    from nrs_design.output import CERTIFICATE, Output, write_outputs

    files: list[Output] = []
    for certificate, box in zip(found.certificates, found.boxes, strict=True):
        name = certificate.id[:SHORT]
        content = dump(certificate, f"{name}.nrs.yaml")
        files.append((folder / f"{name}.cert.json", content, CERTIFICATE))
        files.append((folder / f"{name}.nrs.yaml", found.grid.text_of(box), b""))
    write_outputs(files)
    note(f"{len(found.certificates)} certificates written to {folder}, each with its spec")
