"""Files that a stranger may send: each case writes one into a folder."""

import json
import os
from collections.abc import Callable
from pathlib import Path

from nrs_design.certificates.certificate import SCHEMA, content_id
from nrs_design.spec import read_spec
from tests.support import COMMUTING

MIB = 2**20
HEAD = "kind: switched-system\nname: hostile\ntime: continuous\nswitching: arbitrary\n"
DECEPTIVE = "::error::\u202e\x1b[31m\x9b\u2028\u200b"


def modes(*matrices: list[list[object]]) -> str:
    written = (
        f"- {{name: m{k}, A: {json.dumps([[str(entry) for entry in row] for row in A])}}}\n"
        for k, A in enumerate(matrices)
    )
    return HEAD + "modes:\n" + "".join(written)


def coprime(n: int, digits: int) -> list[list[object]]:
    first = 10 ** (digits - 1) + 1
    return [
        [f"{-1 if i == j else 1}/{first + 2 * (i * n + j)}" for j in range(n)] for i in range(n)
    ]


def dense(n: int, digits: int, stable: bool = False) -> list[list[object]]:
    whole = n if stable else 0

    def entry(i: int, j: int) -> str:
        decimals = f"{10**digits // (i + 2 * j + 3):0{digits}d}"
        return f"-{whole}.{decimals}" if i == j else f"0.{decimals}"

    return [[entry(i, j) for j in range(n)] for i in range(n)]


SPECS: dict[str, Callable[[], str | bytes]] = {
    "empty": lambda: "",
    "binary": lambda: bytes(range(256)) * 100,
    "key of a million digits": lambda: HEAD + "? " + "0" * (MIB - 200) + "x\n: 1\n",
    "keys of a thousand digits": lambda: HEAD + ("? " + "0" * 990 + "x\n: 1\n") * 1000,
    "exclamation marks": lambda: "a: " + "!" * (MIB - 10),
    "list of a million": lambda: "a: [" + "a," * (MIB // 2 - 10) + "a]",
    "list of 80,000": lambda: HEAD + "a: [" + "a," * 80_000 + "a]",
    "unknown keys": lambda: HEAD + "".join(f"nam{i}: 1\n" for i in range(20_000)),
    "deep": lambda: "[" * MIB,
    "spaces": lambda: "a:" + " " * (MIB - 10) + "1",
    "many words": lambda: "a: " + "a " * (MIB // 2 - 10),
    "huge exponent": lambda: modes([["1e999999999"]]),
    "coprime 12": lambda: modes(coprime(12, 90)),
    "coprime 30": lambda: modes(coprime(30, 90)),
    "digits 12": lambda: modes(dense(12, 95)),
    "digits 24": lambda: modes(*[dense(24, 90)] * 4),
    "digits 64": lambda: modes(dense(64, 60)),
    "corners": lambda: HEAD
    + "parameters: {" + ", ".join(f"p{k}: {{nominal: 0, range: [0, 1]}}" for k in range(14))
    + "}\nmodes:\n- {name: m, A: " + json.dumps([["+".join(f"p{k}" for k in range(14))] * 60] * 60)
    + "}\n",
    "deceptive key": lambda: HEAD + json.dumps(DECEPTIVE + "\n::error::x") + ": 1\n",
    "deceptive mode": lambda: HEAD + f"modes: [{{name: {json.dumps(DECEPTIVE)}, A: [[-1]]}}]\n",
    "device name": lambda: modes([[-1]]).replace("hostile", "nul"),
    "folder name": lambda: modes([[-1]]).replace("hostile", '"../outside/x"'),
}  # fmt: skip

LINEAR = "time_s,deflection_m,force_N\n"
RECORDS: dict[str, Callable[[], str | bytes]] = {
    "value of a mebibyte": lambda: LINEAR + "0,0," + "9" * MIB + "\n",
    "text of a mebibyte": lambda: LINEAR + "0,0," + "x" * MIB + "\n",
    "column of a mebibyte": lambda: "time_s,deflection_m,force_" + "x" * MIB + "\n0,0,0\n",
    "a million columns": lambda: "time_s," * (MIB // 7) + "\n",
    "deceptive columns": lambda: f"time_s,deflection_{DECEPTIVE},force_N\n0,0,0\n",
    "deceptive value": lambda: LINEAR + f"0,{DECEPTIVE},0\n",
    "quotes": lambda: '"' * MIB,
    "nulls": lambda: b"\0" * MIB,
}


def fake(**fields: object) -> str:
    """Write a certificate whose id and spec are right, and whose evidence is not."""
    spec = read_spec(COMMUTING)
    document = {
        "schema": SCHEMA,
        "spec": {"name": spec.spec.name, "sha256": spec.sha256},
        "coordinates": None,
        "gains": {},
        "package": {"name": "nrs-design", "version": "0"},
        "statements": [],
        **fields,
    }
    return json.dumps({**document, "id": content_id(document)})


def own_modes(*matrices: list[list[int]]) -> dict[str, object]:
    return {
        "time": "continuous",
        "states": [f"x{i}" for i in range(len(matrices[0]))],
        "modes": [
            {"name": f"m{i}", "numerators": rows, "denominator": 1}
            for i, rows in enumerate(matrices)
        ],
        "switching": "arbitrary",
        "assumptions": [],
        "verdict": "proved",
    }


def unstable(mode: str) -> dict[str, object]:
    return {"kind": "growing-sequence", "steps": [[mode, "1"]]}


CERTIFICATES: dict[str, Callable[[], str | bytes]] = {
    "empty": lambda: "",
    "deep": lambda: "[" * 100_000,
    "long integer": lambda: '{"id": ' + "1" * MIB + "}",
    "lists of nothing": lambda: '{"id": [' + "[]," * (9 * MIB) + "[]]}",
    "long text": lambda: '{"id": "' + "a" * (31 * MIB) + '"}',
    "deceptive kind": lambda: fake(statements=[{"kind": DECEPTIVE + "\n::error::x"}]),
    "deceptive mode": lambda: fake(statements=[unstable(DECEPTIVE + "\n::error::x")]),
    "a million statements": lambda: fake(statements=[unstable("m0")] * 100_000),
    "huge form": lambda: fake(
        statements=[
            {
                "kind": "graph",
                "nodes": [{"place": "modes", "form": [[1 << 12_000] * 20] * 20}],
                "denominator_log2": 0,
                "rate": "1",
            }
        ]
    ),
    "huge modes": lambda: fake(**own_modes([[1 << 12_000] * 40] * 40)),
    "many modes": lambda: fake(
        **own_modes(*[[[-1]]] * 20_000),
        statements=[
            {
                "kind": "graph",
                "rate": "1/2",
                "stays": {"leaving": [], "pieces": 1},
                "nodes": [{"place": f"m{i}", "form": [[1]]} for i in range(20_000)],
                "denominator_log2": 0,
            }
        ],
    ),
}

LOCKS: dict[str, Callable[[], str | bytes]] = {
    "empty": lambda: "",
    "lists of nothing": lambda: '{"specs": [' + "[]," * (9 * MIB) + "[]]}",
    "deep": lambda: "[" * 100_000,
    "300,000 entries": lambda: json.dumps(
        {"specs": [{"path": f"a{i}.nrs.yaml", "sha256": "0" * 64} for i in range(300_000)]}
    ),
    "deceptive entry": lambda: json.dumps({"specs": [{"path": DECEPTIVE + "\n::error::x"}]}),
    "deceptive key": lambda: json.dumps({DECEPTIVE + "\n::error::x": 1}),
}


NAMES = (
    "a\n::error::x.nrs.yaml",
    "\u202eb\x1b[31m.nrs.yaml",
    os.fsdecode(b"c\xff.nrs.yaml"),
    "::error file=x::d.nrs.yaml",
    "-e##[error]e.nrs.yaml",
    "f$\\frac{.nrs.yaml",
)


def write(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
    return path
