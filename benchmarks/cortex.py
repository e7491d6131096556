"""A law on an emulated Cortex-M4F: every instruction, and their count by the clock of QEMU.

Nothing runs on silicon. Unicorn tells every instruction by its address; QEMU tells how many there
were, by a timer that advances with each. Cycles are modelled, as a bracket: see `Counts`.
"""

from __future__ import annotations

import re
import struct
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import unicorn
from numpy.typing import NDArray
from unicorn import arm_const as arm

HERE = Path(__file__).parent
M4F = HERE.parent / "tests/exporters/board"
GCC, PREFIX = "arm-none-eabi-gcc", "arm-none-eabi-"
CORTEX = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")
FLAGS = (*CORTEX, "-O2", "-std=c99", "-ffp-contract=off", "-fno-math-errno")
MACHINE = (
    *("-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none"),
    *("-icount", "shift=8,align=off,sleep=off"),
    *("-semihosting-config", "enable=on,target=native"),
)
FLASH, RAM, SIZE = 0x08000000, 0x20000000, 0x20000
# Ticks of the timer at 168 MHz in one instruction of 2^8 ns.
TICKS = 168e6 * 2**8 * 1e-9
# Where arguments of a function are.
ARGUMENTS = (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2)
# Of the STM32F4: lines of the flash memory, and its wait states at 168 MHz.
LINE, WAIT = 16, 5


@dataclass(frozen=True)
class Counts:
    """Instructions and cycles of each case; stack and code in bytes.

    `cycles`: without wait states, loads one after the other pipelined, one cycle to refill after a
    branch. `cold_cycles`: with five wait states for each new line of flash, none in the cache
    before, and for each load, as if all came from flash, and three to refill.
    """

    instructions: NDArray[np.int64]  # With the return
    by_clock: NDArray[np.int64]  # The same by the clock of QEMU
    cycles: NDArray[np.int64]
    cold_cycles: NDArray[np.int64]
    stack: int
    code: int  # Of the function, with the numbers between its instructions


@dataclass(frozen=True)
class Instruction:
    """One line of a disassembly, as objdump writes it."""

    size: int  # Bytes
    name: str
    operands: str

    @property
    def covers(self) -> int:
        """How many instructions after it hang on its condition."""
        return len(self.name) - 1 if re.fullmatch("it[te]*", self.name) else 0

    @property
    def loads(self) -> int:
        """How many words it reads from memory, or writes."""
        listed = re.search(r"\{(.*)\}", self.operands)
        if listed:
            return sum(map(_registers, listed[1].split(",")))
        return 2 * ("rd" in self.name) or int(bool(re.match("v?(ldr|str)", self.name)))

    def cycles(self, *, refill: int | None, pipelined: bool) -> int:
        """Return how long it takes without wait states, by the manual of the core.

        `refill`: cycles after a branch that is taken. `pipelined`: a load is hidden behind its
        neighbour.
        """
        base = 14 if re.match("v(div|sqrt)", self.name) else 1
        base = 3 if re.match("v(f?n?ml[as]|f?n?m[as])", self.name) else base
        base = 12 if re.match("[us]div", self.name) else base
        wait = 0 if pipelined and self.loads == 1 else self.loads
        return base + wait + (refill or 0)


def _registers(text: str) -> int:
    """Count the registers of one entry of a list, such as s16-s18."""
    ends = [int(number) for number in re.findall(r"[rsd](\d+)", text)]
    count = ends[1] - ends[0] + 1 if len(ends) == 2 else 1
    return 2 * count if text.strip().startswith("d") else count


@dataclass(frozen=True)
class Compiled:
    """The exported C of a law, and what it is called with."""

    name: str  # Of the header and the source
    header: str
    source: str
    own: str  # Beginning of the names in C
    rows: NDArray[np.uint32]  # Shape (n, words): the mode, where there is one, inputs and states
    states: int  # Words that are states


def measure(folder: Path, law: Compiled) -> Counts:
    """Compile a law in a folder, and count."""
    (folder / f"{law.name}.h").write_text(law.header)
    (folder / "law.c").write_text(law.source)
    (folder / "law.h").write_text(_renamed(law))
    _run(GCC, *FLAGS, "-c", folder / "law.c", "-o", folder / "law.o")
    start = (M4F / "startup.c", "-T", M4F / "memory.ld", "--specs=nosys.specs", "-nostartfiles")
    sources = (HERE / "cortex.c", folder / "law.o", *start)
    _run(GCC, *FLAGS, "-I", folder, *sources, "-lm", "-o", folder / "law.elf")
    paths, stack = _traced(folder, law)
    listing = _listing(folder)
    full = [_completed(path, listing) for path in paths]
    return Counts(
        np.array([len(path) for path in full]),
        _by_clock(folder),
        np.array([_cycles(path, listing, cold=False) for path in full]),
        np.array([_cycles(path, listing, cold=True) for path in full]),
        stack,
        _size(folder, f"{law.own}_step"),
    )


def versions() -> str:
    """Return which tools counted."""
    first = [_run(tool, "--version").splitlines()[0] for tool in (GCC, "qemu-system-arm")]
    found = [re.findall(r"\d+\.\d+\.\d+", line)[-1] for line in first]
    return f"{GCC} {found[0]}, QEMU {found[1]}, unicorn {unicorn.__version__}"


def _renamed(law: Compiled) -> str:
    rows, own = law.rows, law.own
    table = ",\n".join("{" + ", ".join(f"0x{n:x}U" for n in row) + "}" for row in rows.tolist())
    kinds = ("input", "state", "output") if law.states else ("input", "output")
    renamed = "".join(f"typedef {own}_{kind}_t {kind}_t;\n" for kind in kinds)
    return (
        f'#include "{law.name}.h"\n#include <stdint.h>\n{renamed}#define STEP {own}_step\n'
        f"#define COUNT {len(rows)}U\n#define HAS_STATE {int(law.states > 0)}\n"
        f"static const uint32_t cases[{len(rows)}][{rows.shape[1]}] = {{\n{table}\n}};\n"
    )


def _run(*command: str | Path) -> str:
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{command[0]}: {done.stderr}")
    return done.stdout or done.stderr


def _by_clock(folder: Path) -> NDArray[np.int64]:
    ticks = _run("qemu-system-arm", *MACHINE, "-kernel", folder / "law.elf").split()
    # The empty function returns, too.
    return np.round(np.array(ticks, float) / TICKS).astype(np.int64) + 1


def _traced(folder: Path, law: Compiled) -> tuple[list[list[int]], int]:
    """Return the addresses of every case, and the largest stack."""
    _run(f"{PREFIX}objcopy", "-O", "binary", folder / "law.elf", folder / "law.bin")
    symbols = _run(f"{PREFIX}nm", folder / "law.elf")
    at = {line.split()[-1]: int(line.split()[0], 16) for line in symbols.splitlines()}
    cpu, path = _processor((folder / "law.bin").read_bytes()), list[int]()
    top, stop = RAM + SIZE - 64, FLASH + 0xFFFF0
    deepest = top

    def seen(emulator: unicorn.Uc, address: int, size: int, data: object) -> None:
        nonlocal deepest
        path.append(address)
        deepest = min(deepest, emulator.reg_read(arm.UC_ARM_REG_SP))

    cpu.hook_add(unicorn.UC_HOOK_CODE, seen)
    places = [at[name] for name in (("in", "state", "out") if law.states else ("in", "out"))]
    inputs = law.rows.shape[1] - law.states
    paths = []
    for row in law.rows.tolist():
        cpu.mem_write(at["in"], struct.pack(f"<{inputs}I", *row[:inputs]))
        if law.states:
            cpu.mem_write(at["state"], struct.pack(f"<{law.states}I", *row[inputs:]))
        for register, value in zip(ARGUMENTS, places, strict=False):
            cpu.reg_write(register, value)
        cpu.reg_write(arm.UC_ARM_REG_SP, top)
        cpu.reg_write(arm.UC_ARM_REG_LR, stop | 1)
        path.clear()
        cpu.emu_start(at[f"{law.own}_step"] | 1, stop)
        paths.append([*path])
    return paths, top - deepest


def _processor(flash: bytes) -> unicorn.Uc:
    """Return a processor with its unit for floating point switched on."""
    cpu = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB | unicorn.UC_MODE_MCLASS)
    cpu.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
    cpu.mem_map(FLASH, 0x100000)
    cpu.mem_map(RAM, SIZE)
    cpu.mem_write(FLASH, flash)
    cpu.reg_write(arm.UC_ARM_REG_C1_C0_2, cpu.reg_read(arm.UC_ARM_REG_C1_C0_2) | 0xF << 20)
    cpu.reg_write(arm.UC_ARM_REG_FPEXC, 0x40000000)
    return cpu


def _listing(folder: Path) -> dict[int, Instruction]:
    text = _run(f"{PREFIX}objdump", "-d", "--no-show-raw-insn", folder / "law.elf")
    raw = _run(f"{PREFIX}objdump", "-d", folder / "law.elf")
    sizes = {
        int(m[1], 16): 4 if " " in m[2].strip() else 2
        for m in re.finditer(r"^ ([0-9a-f]+):\t([0-9a-f ]+)\t", raw, re.MULTILINE)
    }
    lines = re.finditer(r"^ ([0-9a-f]+):\t(\S+)\t?(.*)$", text, re.MULTILINE)
    return {
        int(m[1], 16): Instruction(
            sizes[int(m[1], 16)], m[2].removesuffix(".n").removesuffix(".w"), m[3]
        )
        for m in lines
        if int(m[1], 16) in sizes
    }


def _completed(path: Sequence[int], listing: dict[int, Instruction]) -> list[int]:
    """Return a path with the instructions whose condition fails: unicorn does not tell of them."""
    found: list[int] = []
    due: list[int] = []
    for address in path:
        while due and due[0] != address:
            found.append(due.pop(0))
        if due:
            due.pop(0)
        found.append(address)
        instruction, after = listing[address], address
        if instruction.covers:
            for _ in range(instruction.covers):
                after += listing[after].size
                due.append(after)
    return [*found, *due]


def _cycles(path: Sequence[int], listing: dict[int, Instruction], *, cold: bool) -> int:
    refill, lines, total = (3 if cold else 1), set[int](), 0
    for k, address in enumerate(path):
        instruction = listing[address]
        after = path[k + 1] if k + 1 < len(path) else None
        jumps = after != address + instruction.size
        total += instruction.cycles(refill=refill if jumps else None, pipelined=not cold)
        if cold:
            total += WAIT * instruction.loads
            touched = {address // LINE, (address + instruction.size - 1) // LINE}
            total += WAIT * len(touched - lines)
            lines |= touched
    return total


def _size(folder: Path, function: str) -> int:
    """Return the bytes of a function, with the numbers between its instructions."""
    sized = _run(f"{PREFIX}nm", "-S", folder / "law.elf").splitlines()
    (line,) = [line.split() for line in sized if line.split()[-1] == function]
    return int(line[1], 16)
