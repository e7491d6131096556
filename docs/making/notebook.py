"""A notebook that is a Python file: cells that begin with ``# %%``, run while the page is made.

Editors that know these marks open the file as a notebook; the site has it as a page and as an
``.ipynb``, both with what the cells printed and drew. An error in a cell stops the build.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
import re
from pathlib import Path
from typing import Any, NamedTuple

MARK = re.compile(r"^# %%( \[markdown\])?$\n", re.MULTILINE)


class Cell(NamedTuple):
    """A part of the notebook, and what running it gave."""

    is_code: bool
    source: str
    printed: str = ""
    images: tuple[bytes, ...] = ()


def read_cells(text: str) -> list[Cell]:
    """Split a file into its cells; what stands before the first mark is a comment on the file."""
    parts = MARK.split(text)[1:]
    return [
        Cell(mark is None, source.strip("\n") if mark is None else _uncommented(source))
        for mark, source in zip(parts[::2], parts[1::2], strict=True)
    ]


def _uncommented(source: str) -> str:
    return "\n".join(re.sub("^# ?", "", line) for line in source.strip("\n").splitlines())


def run_cells(cells: list[Cell]) -> list[Cell]:
    """Run the code, from top to bottom in one namespace, and keep what it printed and drew."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    return [_run(cell, namespace) if cell.is_code else cell for cell in cells]


def _run(cell: Cell, namespace: dict[str, Any]) -> Cell:
    statements = ast.parse(cell.source).body
    last = statements.pop() if statements and isinstance(statements[-1], ast.Expr) else None
    images: list[bytes] = []
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(compile(ast.Module(statements, []), "<cell>", "exec"), namespace)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "<cell>", "eval"), namespace)
            if hasattr(value, "savefig"):
                images.append(_drawn(value))
            elif value is not None:
                print(value if hasattr(value, "_repr_html_") else repr(value))
    return cell._replace(printed=out.getvalue(), images=tuple(images))


def _drawn(figure: Any) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=150)
    return buffer.getvalue()


def page_of(cells: list[Cell], name: str) -> tuple[str, dict[str, bytes]]:
    """Return the notebook as Markdown, and its images by file name."""
    lines: list[str] = []
    images: dict[str, bytes] = {}
    for cell in cells:
        if not cell.is_code:
            lines += [cell.source, ""]
            continue
        lines += ["```python", cell.source, "```", ""]
        if cell.printed:
            lines += ["```text", cell.printed.rstrip(), "```", ""]
        for image in cell.images:
            file = f"{name}-{len(images) + 1}.png"
            images[file] = image
            lines += [f"![What the cell above draws]({file})", ""]
    return "\n".join(lines), images


def notebook_of(cells: list[Cell]) -> str:
    """Return the notebook in the format of Jupyter (nbformat 4.5), with its output."""
    document = {
        "cells": [_jupyter(number, cell) for number, cell in enumerate(cells)],
        "metadata": {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        },
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def _jupyter(number: int, cell: Cell) -> dict[str, Any]:
    common = {"id": f"cell-{number}", "metadata": {}, "source": cell.source.splitlines(True)}
    if not cell.is_code:
        return {"cell_type": "markdown", **common}
    outputs: list[dict[str, Any]] = []
    if cell.printed:
        text = cell.printed.splitlines(True)
        outputs.append({"output_type": "stream", "name": "stdout", "text": text})
    for image in cell.images:
        data = {"image/png": base64.b64encode(image).decode()}
        outputs.append({"output_type": "display_data", "metadata": {}, "data": data})
    return {"cell_type": "code", "execution_count": None, "outputs": outputs, **common}


def made(path: Path) -> list[Cell]:
    """Read and run a notebook."""
    return run_cells(read_cells(path.read_text(encoding="utf-8")))
