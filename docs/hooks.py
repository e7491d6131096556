"""What mkdocs calls: pages and figures that are made from the package, and what stops the build.

mkdocs knows the functions by their names (``on_files``, ``on_page_markdown``, ``on_page_content``,
``on_post_page``, ``on_post_build``).
"""

from __future__ import annotations

import json
import re
from itertools import count
from pathlib import Path

from making.assumptions import assumptions_table
from making.combinations import combinations_table
from making.commands import commands_page
from making.cost import cost_figures
from making.dissertation import misprints_table, reproduced_table
from making.faults import refuse
from making.fields import spec_page
from making.floors import drawing
from making.growth import growth_table
from making.library import library_page
from making.notebook import made, notebook_of, page_of
from making.offline import loaded_from_elsewhere
from making.rules import rules_page
from making.schemas import schema_names, schema_text, schemas_page
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
NOTEBOOK = ROOT / "docs" / "tutorial_python.py"
COST_SPEC = ROOT / "specs" / "neuroboscope" / "soft-tissue.nrs.yaml"
SCROLLED = '<div class="table-scroll" role="region" aria-label="Table {}" tabindex="0">'
# What scripts of the theme look for although highlighting is off; without it they stop.
SWITCHED = '<style id="hljs-light"></style><style id="hljs-dark"></style>'
# Where a page says so, what is made stands in its place.
MADE = re.compile(r"^<!-- made: (\w+) -->$", re.MULTILINE)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages and figures that are made, and the specs that pages refer to."""
    for name, content in {**_reference(), **_notebook(), **_figures(), **_specs()}.items():
        files.append(File.generated(config, name, content=content))
    return files


def _specs() -> dict[str, str | bytes]:
    paths = sorted((ROOT / "specs").rglob("*.yaml"))
    return {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in paths}


def _reference() -> dict[str, str | bytes]:
    shipped = sorted((ROOT / "specs").rglob("*.nrs.yaml"))
    examples = sorted((ROOT / "docs" / "examples").glob("*.nrs.yaml"))
    specs = [(f"../../{path.relative_to(ROOT).as_posix()}", path) for path in shipped]
    specs += [(f"../examples/{path.name}", path) for path in examples]
    schemas = {name: schema_text(name) for name in schema_names()}
    return {
        "reference/spec.md": spec_page(specs),
        "reference/commands.md": commands_page(),
        "reference/rules.md": rules_page(),
        "reference/library.md": library_page(),
        "reference/schemas.md": schemas_page(schemas),
        **{f"reference/{name}.schema.json": text for name, text in schemas.items()},
    }


def _notebook() -> dict[str, str | bytes]:
    cells = made(NOTEBOOK)
    page, images = page_of(cells, "tutorial-python")
    return {"tutorial-python.md": page, "tutorial-python.ipynb": notebook_of(cells), **images}


def _figures() -> dict[str, str | bytes]:
    return {f"explanation/{name}": image for name, image in cost_figures(COST_SPEC).items()}


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Put in what is made, and point links at specs, beside the documentation, to their copies."""
    makers = {
        "assumptions": assumptions_table,
        "combinations": combinations_table,
        "floors": lambda: drawing(ROOT / "nrs_design", markdown),
        "growth": lambda: growth_table(ROOT / "tests" / "literature" / "growth_per_step.yaml"),
        "misprints": misprints_table,
        "reproduced": reproduced_table,
    }
    markdown = MADE.sub(lambda match: makers[match[1]](), markdown)
    return re.sub(r"\]\(\.\./((?:\.\./)*specs/)", r"](\1", markdown)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let wide tables and code scroll by themselves, by keyboard too."""
    number = count(1)
    html = re.sub("<table[ >]", lambda match: SCROLLED.format(next(number)) + match[0], html)
    html = html.replace("</table>", "</table></div>").replace("<th></th>", "<td></td>")
    return html.replace("<pre>", '<pre tabindex="0">')


def on_post_page(output: str, page: Page, config: MkDocsConfig) -> str:
    """Stop the build where a page would load something from a network."""
    refuse(f"{page.file.src_uri} loads from elsewhere", loaded_from_elsewhere(output))
    return output.replace("</head>", f"{SWITCHED}</head>")


def on_post_build(config: MkDocsConfig) -> None:
    """Make the texts that are searched a script, which a page may load from a folder."""
    folder = Path(config.site_dir) / "search"
    index = folder / "search_index.json"
    documents = json.loads(index.read_text(encoding="utf-8"))["docs"]
    script = f"const search_documents = {json.dumps(documents)};\n"
    (folder / "index.js").write_text(script, encoding="utf-8")
    index.unlink()
    (folder / "worker.js").unlink()
