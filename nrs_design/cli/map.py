"""``nrs-design map``: what is proved, refuted or undecided over fields of a spec."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import check_beside
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.reading import take_spec
from nrs_design.facts.spec import spec_facts
from nrs_design.proof.text import counted

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
    refine: Annotated[
        int,
        typer.Option(
            min=0,
            max=8,
            help="So many times, halve the intervals that are not proved beside proved ones.",
        ),
    ] = 0,
    figure: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw one or two fields as a PNG image.")
    ] = None,
    table: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Write a row for every tile.")
    ] = None,
    npz: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Write verdicts and certificates as arrays for NumPy."),
    ] = None,
    mark: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=LOW..HIGH UNIT",
            help="Draw an interval into the figure, such as 'hand=434..1570 N/m'; ranges that the "
            "spec declares are drawn anyway.",
        ),
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
    from nrs_design.output import MAP, MAP_ARCHIVE, PNG, check_place, write_outputs
    from nrs_design.pipeline import run_design
    from nrs_design.pipeline.written_gains import with_own_gains
    from nrs_design.sweeps.idle import idle_fields
    from nrs_design.sweeps.marks import declared_marks, read_marks
    from nrs_design.sweeps.paint import check_corners, run_tile_map
    from nrs_design.sweeps.refine import refined
    from nrs_design.sweeps.tile_table import tiles_csv, tiles_npz
    from nrs_design.sweeps.tiles import read_tiles

    for path, kind in ((figure, PNG), (table, MAP), (npz, MAP_ARCHIVE)):
        if path is not None:
            check_place(path, kind)
    loaded = take_spec(spec)
    if certificates is not None:
        check_place(certificates / "x")
        check_beside(loaded, certificates / "x")
    designed = run_design(loaded)
    grid = read_tiles(loaded if designed is None else with_own_gains(designed), spec, over)
    marks = (*declared_marks(grid), *read_marks(grid, mark or ()))
    if certificates is not None:
        # The ends of the map, so that a long search is not for nothing.
        check_corners(grid, designed)
    idle = idle_fields(grid, designed)
    with progress(f"map of {loaded.spec.name}") as step:
        found = refined(run_tile_map(grid, designed, step), designed, refine, step)
    outputs: list[Output] = []
    if figure is not None:
        from nrs_design.reporting.images import to_png
        from nrs_design.sweeps.tile_figure import draw_tile_map

        outputs.append((figure, to_png(draw_tile_map(found, marks)), PNG))
    if table is not None:
        outputs.append((table, tiles_csv(found), MAP))
    if npz is not None:
        outputs.append((npz, tiles_npz(found), MAP_ARCHIVE))
    if certificates is not None:
        outputs += _certificates(found, certificates)
    write_outputs(outputs)
    for path in (figure, table, npz, certificates):
        if path is not None:
            note(f"written: {path}")
    codes = {OF_VERDICT[str(tile.verdict)] for tile in found.tiles.values()}
    asked = loaded, found, idle
    return Answer(partial(_facts, *asked), partial(_print, *asked), worst(codes))


def _facts(loaded: LoadedSpec, found: TileMap, idle: tuple[str, ...]) -> dict[str, Any]:
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
            {
                "id": certificate.id,
                "box": [list(span) for span in box],
                "assumptions": certificate.granted,
            }
            for certificate, box in zip(found.certificates, found.boxes, strict=True)
        ],
        "without_effect": idle,
        "programs": found.proofs,
        "forms_carried": found.carried,
        "witnesses_sought": found.witnesses,
    }


def _print(loaded: LoadedSpec, found: TileMap, idle: tuple[str, ...]) -> None:
    verdicts = ", ".join(f"{count} {name}" for name, count in found.counts().items())
    say(
        f"{loaded.spec.name}: {len(found.tiles)} tiles: {verdicts}; "
        f"{found.proofs} programs, {found.carried} forms carried on, growth looked for "
        f"{found.witnesses} times"
    )
    fields = found.grid.fields
    if len(fields) == 2 and fields[0].count <= WIDEST:
        _draw(found)
    elif len(fields) == 1:
        for place, tile in found.tiles.items():
            say(f"  {fields[0].text(place[0])}: {tile.shown}")
    else:
        say("--figure, --csv or --json have the tiles")
    granted = max((len(one.granted) for one in found.certificates), default=0)
    if granted:
        say(f"  takes up to {counted(granted, 'thing')} for granted (--certificates or --json)")
    for path in idle:
        note(f"warning: {path} has no part in what is decided: its tiles say nothing about it")
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


def _certificates(found: TileMap, folder: Path) -> Iterator[Output]:
    """Yield every certificate, and the spec that it is about, with the gains that it is about."""
    from nrs_design.certificates.certificate import dump
    from nrs_design.output import CERTIFICATE
    from nrs_design.pipeline.free_gains import check_own_gains

    for certificate, box in zip(found.certificates, found.boxes, strict=True):
        check_own_gains(found.grid.spec_of(box), certificate.gains)
        name = certificate.id[:SHORT]
        text = found.grid.text_of(box)
        yield folder / f"{name}.cert.json", dump(certificate, f"{name}.nrs.yaml"), CERTIFICATE
        # In the place of the same text only: whoever changed it works with it.
        same = re.compile(re.escape(text.encode()) + rb"\Z")
        yield folder / f"{name}.nrs.yaml", text, same
