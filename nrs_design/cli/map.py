"""``nrs-design map``: what is proved, refuted or undecided over fields of a spec."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command, spec_facts
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.reading import take_spec

if TYPE_CHECKING:
    from nrs_design.output import Output
    from nrs_design.spec import LoadedSpec
    from nrs_design.sweeps.tile_map import TileMap

SIGNS = {"proved": "#", "refuted": "x", "inconclusive": "."}
# Refuted in kept contact: open where contact may be lost.
IN_CONTACT = "o"
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
    sampling.delay: [0, 1], the upper end takes each value; any other takes each value by itself.
    Gains are those of the spec in all tiles. The exit code is 0 if all tiles are proved, 1 if one
    is refuted.

    Example: nrs-design map specs/neuroboscope/soft-tissue-sampled.nrs.yaml
    --over 'environments.soft.stiffness=100..1700/8 N/m' --over sampling.delay=0..3
    """
    from nrs_design.cli.exit_codes import OF_VERDICT, worst
    from nrs_design.output import MAP, PNG, check_place, write_outputs
    from nrs_design.pipeline import run_design
    from nrs_design.pipeline.written_gains import with_own_gains
    from nrs_design.sweeps.tile_map import run_tile_map
    from nrs_design.sweeps.tiles import read_tiles

    for path, kind in ((figure, PNG), (table, MAP)):
        if path is not None:
            check_place(path, kind)
    if certificates is not None:
        check_place(certificates / "x")
    loaded = take_spec(spec)
    designed = run_design(loaded)
    grid = read_tiles(loaded if designed is None else with_own_gains(designed), spec, over)
    with progress(f"map of {loaded.spec.name}") as step:
        found = run_tile_map(grid, designed, step)
    outputs: list[Output] = []
    if figure is not None:
        from nrs_design.reporting.images import to_png
        from nrs_design.sweeps.tile_figure import draw_tile_map

        outputs.append((figure, to_png(draw_tile_map(found)), PNG))
    if table is not None:
        outputs.append((table, _table(found), MAP))
    if certificates is not None:
        outputs += _certificates(found, certificates)
    write_outputs(outputs)
    for path in (figure, table, certificates):
        if path is not None:
            note(f"written: {path}")
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
    counted = ", ".join(f"{count} {name}" for name, count in found.counts().items())
    say(
        f"{loaded.spec.name}: {len(found.tiles)} tiles: {counted}; "
        f"{found.proofs} proofs and {found.witnesses} witnesses tried"
    )
    fields = found.grid.fields
    if len(fields) == 2 and fields[0].count <= WIDEST:
        _draw(found)
    elif len(fields) == 1:
        for place, tile in found.tiles.items():
            say(f"  {fields[0].text(place[0])}: {tile.shown}")
    else:
        say("--figure, --csv or --json have the tiles")
    wrong = next((tile.wrong for tile in found.tiles.values() if tile.wrong), None)
    if wrong is not None:
        note(f"warning: some tiles make no system: {wrong}")


def _draw(found: TileMap) -> None:
    """Draw the first field across, and the second one up."""
    across, up = found.grid.fields
    width = max(len(up.text(k)) for k in range(up.count))
    for level in reversed(range(up.count)):
        tiles = (found.tiles[k, level] for k in range(across.count))
        signs = "".join(SIGNS.get(tile.shown, IN_CONTACT) for tile in tiles)
        say(f"  {up.text(level):>{width}} |{signs}")
    say(f"  {'':>{width}} {across.text(0)} to {across.text(across.count - 1)}")
    meant = [f"{SIGNS.get(name, IN_CONTACT)} {name}" for name, n in found.counts().items() if n]
    say(f"  {', '.join(meant)}; up: {up.field.path}, across: {across.field.path}")


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


def _certificates(found: TileMap, folder: Path) -> Iterator[Output]:
    """Yield every certificate, and the spec that it is about, with the gains that it is about.

    Raises
    ------
    DesignError
        If the spec of a box, by itself, would have other gains.
    """
    from nrs_design.certificates.certificate import dump
    from nrs_design.errors import DesignError
    from nrs_design.output import CERTIFICATE
    from nrs_design.pipeline import run_design
    from nrs_design.pipeline.certification import gains_text

    for certificate, box in zip(found.certificates, found.boxes, strict=True):
        text, own = found.grid.text_of(box), run_design(found.grid.spec_of(box))
        if gains_text(own) != {name: dict(gains) for name, gains in certificate.gains.items()}:
            raise DesignError(
                "gains of this spec follow from what the map changes, so no spec has the gains of "
                "its certificates",
                path=found.grid.loaded.path,
                remedy="give these gains in the spec, or leave --certificates out",
            )
        name = certificate.id[:SHORT]
        yield folder / f"{name}.cert.json", dump(certificate, f"{name}.nrs.yaml"), CERTIFICATE
        yield folder / f"{name}.nrs.yaml", text, b""
