"""A shared library from C, by the compiler of this system, the same bytes each time."""

from __future__ import annotations

import platform
import shutil
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from nrs_design.errors import DesignError
from nrs_design.processes import run_program

# No path, time or random name gets into the library.
FLAGS = (
    *("-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-shared", "-s"),
    *("-Wl,--build-id=none", "-frandom-seed=nrs-design"),
)


def compiler() -> str | None:
    """Return the compiler for 64-bit Linux on an x86 processor, if this system is and has one."""
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        return None
    return shutil.which("cc")


def shared_library(compile_with: str, sources: Mapping[str, str]) -> bytes:
    """Compile sources, by their names, with a compiler that takes the flags of GCC."""
    with TemporaryDirectory(prefix="nrs-design-") as folder:
        for name, text in sources.items():
            (Path(folder) / name).write_text(text, encoding="ascii")
        files = [name for name in sources if name.endswith(".c")]
        done = run_program(compile_with, [*FLAGS, "-o", "library.so", *files], folder)
        if done.returncode:
            raise DesignError(
                f"{compile_with} does not compile the law: {done.stderr.strip()[:500]}",
                remedy="repair the compiler; without one, sources alone are written",
            )
        return (Path(folder) / "library.so").read_bytes()
