"""Families of matrices with a published growth per step, as their tests compare it."""

from __future__ import annotations

from pathlib import Path

from ruamel.yaml import YAML


def growth_table(path: Path) -> str:
    """List each family with the printed growth and the length of the published word."""
    lines = ["| family | printed | length of the word |", "|---|---|---|"]
    for name, known in YAML(typ="safe").load(path.read_text(encoding="utf-8")).items():
        word = len(known["word"]) if known["word"] else ""
        lines.append(f"| {name} | {known['printed'] or ''} | {word} |")
    return "\n".join(lines)
