"""What users build on, one line each; ``python -m tests.stable`` writes it down at a release.

Lines are only ever added from 1.0 on: a line that is gone breaks somebody, and waits for 2.0.
"""

import inspect
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

import nrs_design
from nrs_design import api
from nrs_design.certificates.certificate import SCHEMA as CERTIFICATE
from nrs_design.cli import exit_codes
from nrs_design.cli.app import make_app
from nrs_design.exporters.record import record_schema_text
from nrs_design.gating.lock import Lock
from nrs_design.gating.rules import RULES
from nrs_design.spec.schema import json_schema

RELEASED = Path(__file__).with_name("stable.txt")


def promises() -> list[str]:
    exits = {k: v for k, v in vars(exit_codes).items() if k.isupper() and isinstance(v, int)}
    schemas = {
        "spec": json_schema(),
        "export": json.loads(record_schema_text()),
        "lock": Lock.model_json_schema(),
    }
    found = [f"certificate {CERTIFICATE}"]
    found += [f"exit code {code}: {name}" for name, code in exits.items()]
    found += [f"rule {rule}" for rule in RULES]
    found += _commands(typer.main.get_command(make_app()), "nrs-design")
    for name in nrs_design.__all__:
        found += _members(name, getattr(api, name))
    for name, schema in schemas.items():
        found += _keys(name, schema)
    return sorted(set(found))


def _commands(command: Any, path: str) -> Iterator[str]:
    yield path
    for parameter in command.params:
        yield from (f"{path} {option}" for option in (*parameter.opts, *parameter.secondary_opts))
    for name, inner in getattr(command, "commands", {}).items():
        yield from _commands(inner, f"{path} {name}")


def _members(name: str, member: Any) -> Iterator[str]:
    yield f"nrs_design.{name}"
    if inspect.isclass(member):
        public = [inner for inner in dir(member) if not inner.startswith("_")]
        yield from (f"nrs_design.{name}.{inner}" for inner in public)
    else:
        yield from (f"nrs_design.{name}({given})" for given in inspect.signature(member).parameters)


def _keys(name: str, schema: dict[str, Any]) -> Iterator[str]:
    """Keys of every object of a schema, by the name of its definition."""
    definitions = {**schema.get("$defs", {}), **schema.get("definitions", {}), "": schema}
    for definition, described in definitions.items():
        for key in described.get("properties", ()):
            yield f"{name} {definition}.{key}"


if __name__ == "__main__":
    RELEASED.write_text("\n".join([*promises(), ""]), encoding="utf-8")
