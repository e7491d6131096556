"""A command that does nothing, on the libraries that a proof uses: what no start can fall below."""

import sys
from pathlib import Path

import flint  # noqa: F401
import numpy  # noqa: F401
import ruamel.yaml  # noqa: F401
import typer
from pydantic import BaseModel


class Pair(BaseModel):
    """A spec of one field."""

    name: str


def main(path: Path, rate: float = 1.0) -> None:
    """Read one argument, as Typer reads those of any command."""
    Pair(name=f"{path} {rate}")


if __name__ == "__main__":
    sys.argv = ["empty", "spec"]
    typer.run(main)
