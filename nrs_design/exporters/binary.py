"""From deployed sources to a binary that was tested, by the user's own compiler and emulator.

The law is compiled to an object by itself, as a build of the robot does it, and that object is
linked with the self-test: what the record names by its hash is what passed.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from nrs_design.errors import NrsDesignError
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.run_command import Done, run_command
from nrs_design.exporters.self_test import passed_text, program_macro
from nrs_design.progress import Progress

BOARD = Path(__file__).parent / "board"
START, MEMORY = "startup.c", "memory.ld"
# For code of Cortex-M: an STM32F405, whose start is in `board`; text leaves by semihosting.
EMULATED = "arm-none-eabi"
EMULATOR = (
    *("qemu-system-arm", "-M", "netduinoplus2", "-nographic", "-monitor", "none"),
    *("-serial", "none", "-semihosting-config", "enable=on,target=native", "-kernel"),
)
_ON_BOARD = ("-T", MEMORY, "--specs=nosys.specs", "-nostartfiles")
# Where a runner wants the program, if not at its end.
PLACE = "{program}"
# No source, and nothing that links one, is larger.
_LARGEST_BYTES = 2**24


@dataclass(frozen=True, slots=True)
class Toolchain:
    """Commands of the user, as words."""

    compile: tuple[str, ...]  # Compiler and flags
    # What links the self-test beside the objects, and what runs it; None for what fits the code.
    link: tuple[str, ...] | None = None
    run: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True)
class Binary:
    """What was compiled and run."""

    version: str  # What the compiler says of itself
    target: str  # For what it compiles; empty if it does not say
    link: tuple[str, ...]
    run: tuple[str, ...]
    sources: dict[str, str]  # SHA-256 of each file that was compared, as it was compiled, by name
    objects: dict[str, str]  # The same of objects and of the program that ran
    result: str = ""  # What the self-test said where it passed
    fault: str = ""  # Why it is not the law; empty if it passed
    said: str = ""  # What the command that failed said

    @property
    def emulated(self) -> bool:
        """Whether the emulator that fits the code ran it."""
        return self.run == EMULATOR


def build_binary(
    folder: Path, files: Sequence[Path], names: CNames, tools: Toolchain, progress: Progress
) -> Binary:
    """Compile the law of a folder, link its self-test and run it.

    Everything happens in a scratch folder, which holds a copy of the files.

    Parameters
    ----------
    folder : Path
        Deployed files; those that the commands need beside exports, too.
    files : sequence of Path
        Those that were compared, and are no others than what was exported.
    names : CNames
        Of the spec.
    tools : Toolchain
        Commands of the user.
    progress : callable
        Told the name of each step.

    Raises
    ------
    NrsDesignError
        If a self-test is missing, or a command cannot be run or does not end.
    """
    if f"{names.spec}_test.c" not in {file.name for file in files}:
        raise NrsDesignError(
            f"holds no {names.spec}_test.c, which tests what is compiled",
            path=folder,
            remedy="write it there: nrs-design export SPEC --format vectors --out FOLDER",
        )
    with TemporaryDirectory(prefix="nrs-design-") as scratch:
        here = Path(scratch)
        for file in sorted(path for path in folder.iterdir() if path.is_file()):
            if file.stat().st_size <= _LARGEST_BYTES:
                shutil.copyfile(file, here / file.name)
        return _Bench(here, names, tools, progress).build(files)


@dataclass(frozen=True, slots=True)
class _Bench:
    """A scratch folder, and what is done there."""

    here: Path
    names: CNames
    tools: Toolchain
    progress: Progress

    def build(self, files: Sequence[Path]) -> Binary:
        version, target = self._compiler()
        link, run = self._fitting(target)
        made = Binary(version, target, link, run, self._hashes(f.name for f in files), {})
        sources = sorted(file.name for file in files if file.suffix == ".c")
        # What debuggers read would name the scratch folder, and no two objects would be the same.
        more = (f"-fdebug-prefix-map={self.here}=.",) if target else ()
        for source in sources:
            self.progress(f"compile {source}")
            done = self._compile(source, *more)
            if done.code:
                return self._failed(made, f"the compiler refuses {source}", done)
        objects = [_object(source) for source in sources]
        self.progress("link and run the self-test")
        done = self._command("--compile", *self.tools.compile, *objects, *link, "-o", "program")
        if done.code:
            return self._failed(made, "the self-test does not link", done)
        if not (self.here / "program").is_file():
            return self._failed(made, "linking made no program: leave -c, -S and -E out", done)
        kept = [name for name in objects if name != f"{self.names.spec}_test.o"]
        made = replace(made, objects=self._hashes([*kept, "program"]))
        done = self._run(run)
        # How many cases there are, the source says, which was compared.
        passed = re.search(passed_text(self.names, r"\d+"), done.said)
        if passed is None:
            return self._failed(made, "the self-test does not say that it passed", done)
        if done.code:
            return self._failed(made, f"the self-test ended with {done.code}", done)
        return replace(made, result=passed[0])

    def _compiler(self) -> tuple[str, str]:
        """Return the first line of its version, and its target, as far as it says them."""
        version, target = (
            self._command("--compile", *self.tools.compile, option)
            for option in ("--version", "-dumpmachine")
        )
        first = version.said.strip().partition("\n")[0] if version.code == 0 else ""
        return first or "not said", target.said.strip() if target.code == 0 else ""

    def _fitting(self, target: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Return how the self-test is linked and run: as asked for, or as the code needs it."""
        link, run = self.tools.link, self.tools.run
        if not target.startswith(EMULATED) or link is not None:
            return link or (), run or (EMULATOR if target.startswith(EMULATED) else ())
        for name in (START, MEMORY):
            shutil.copyfile(BOARD / name, self.here / name)
        # Flags of the user may refuse what only a start needs.
        if (done := self._compile(START, "-w")).code:
            raise NrsDesignError(
                f"the start of an emulated Cortex-M4F does not compile with these flags: "
                f"{_first_error(done)}",
                remedy="add -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard; for "
                "another processor, --link and --run say how to link and run",
            )
        return (_object(START), *_ON_BOARD), run or EMULATOR

    def _compile(self, source: str, *more: str) -> Done:
        test = f"{self.names.spec}_test.c"
        macro = (f"-D{program_macro(self.names)}",) if source == test else ()
        words = (*self.tools.compile, *more, *macro, "-c", source, "-o", _object(source))
        return self._command("--compile", *words)

    def _run(self, runner: Sequence[str]) -> Done:
        program = str(self.here / "program")
        words = [word.replace(PLACE, program) for word in runner]
        return self._command("--run", *words, *([] if words != [*runner] else [program]))

    def _command(self, option: str, *words: str) -> Done:
        return run_command(words, self.here, option)

    def _hashes(self, names: Iterable[str]) -> dict[str, str]:
        return {name: sha256((self.here / name).read_bytes()).hexdigest() for name in names}

    def _failed(self, made: Binary, fault: str, done: Done) -> Binary:
        return replace(made, fault=fault, said=done.said.replace(f"{self.here}/", ""))


def _object(source: str) -> str:
    return f"{source.removesuffix('.c')}.o"


def _first_error(done: Done) -> str:
    """Return the first line that names an error; what follows it is often a list of choices."""
    lines = [line.strip() for line in done.said.splitlines() if line.strip()]
    errors = [line for line in lines if "error: " in line.lower()]
    return " ".join([*errors, *lines][:1])[:300]
