"""A binary from deployed sources: flags that make another law of it are found, all are recorded."""

import json
import shutil
import sys
from hashlib import sha256

import pytest

from nrs_design.errors import NrsDesignError, OutputError
from nrs_design.exporters.binary import BOARD, EMULATOR, Toolchain, build_binary
from nrs_design.exporters.binary_record import binary_document, write_record
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.deployed import compare_deployed
from nrs_design.progress import silent
from tests.exporters.programs import CORTEX, compiler, run, write_formats

NAMES = CNames("soft-tissue")
SAME = "soft-tissue: all 1000 cases are the same"
FAILED = "the self-test does not say that it passed"
FUSED = ("-O3", "-march=haswell", "-ffp-contract=fast")


@pytest.fixture(scope="module")
def exported(sampled_export, tmp_path_factory):
    return write_formats(tmp_path_factory.mktemp("exported"), sampled_export, ("c", "vectors"))


@pytest.fixture
def built(exported, tmp_path):
    """Build the deployed files, or what is left of them after a change."""
    folder = shutil.copytree(exported, tmp_path / "firmware")

    def build(*flags, old="", new="", cc="gcc", **tools):
        source = folder / "soft-tissue.c"
        source.write_text(source.read_text().replace(old, new, 1) if old else source.read_text())
        compiler(cc)
        words = Toolchain((cc, *flags), **tools)
        return build_binary(folder, sorted(folder.iterdir()), NAMES, words, silent)

    return build


def test_a_law_that_passes_is_named_by_the_hash_of_its_object(built, exported, tmp_path):
    made = built("-O2")
    assert (made.fault, made.said, made.emulated) == ("", "", False)
    assert "gcc" in made.version
    assert set(made.objects) == {"soft-tissue.o", "program"}
    assert built("-O2").objects == made.objects
    assert built("-O1").objects["soft-tissue.o"] != made.objects["soft-tissue.o"]
    # A build of the robot makes the same, wherever it is.
    run("gcc", "-O2", "-c", exported / "soft-tissue.c", "-o", tmp_path / "law.o")
    assert made.objects["soft-tissue.o"] == sha256((tmp_path / "law.o").read_bytes()).hexdigest()
    # Where it was built is in no object, even with what a debugger reads.
    assert built("-O2", "-g").objects == built("-O2", "-g").objects


def test_on_an_emulated_processor(built):
    made = built(*CORTEX, "-O2", cc="arm-none-eabi-gcc")
    assert (made.fault, made.emulated) == ("", True)
    assert made.target == "arm-none-eabi"


@pytest.mark.parametrize(
    ("flag", "said"),
    [
        ("-ffast-math", "-ffast-math"),
        ("-Ofast", "-ffast-math"),
        ("-ffinite-math-only", "-ffinite-math-only"),
        ("-freciprocal-math", "parts of it"),
        ("-funsafe-math-optimizations", "parts of it"),
        ("-mfpmath=387", "round to single precision"),
    ],
)
def test_flags_of_other_arithmetic_are_refused(built, flag, said):
    made = built(flag)
    assert made.fault == "the compiler refuses soft-tissue.c"
    assert said in made.said


def test_products_are_not_fused_whatever_the_flags_say(built):
    """Without the pragma they are, and the vectors find it: here, and on a Cortex-M4F."""
    assert built(*FUSED).fault == ""
    assert built(*FUSED, "-flto").fault == ""
    arm = (*CORTEX, "-O3", "-ffp-contract=fast")
    assert built(*arm, cc="arm-none-eabi-gcc").fault == ""
    # To who says that it is clang, GCC gives the pragma that it does not heed.
    lied = built(*FUSED, "-D__clang__")
    assert (lied.fault, "differs" in lied.said) == (FAILED, True)
    lied = built(*arm, "-D__clang__", cc="arm-none-eabi-gcc")
    assert (lied.fault, "differs" in lied.said) == (FAILED, True)


def test_what_only_the_vectors_see(built):
    """Subnormal numbers that a start sets to zero, floats that are doubles, a sign."""
    assert "differs" in built("-O2", link=("-ffast-math",)).said
    assert built("-Dfloat=double", "-w").fault
    changed = built("-O2", old="proportional + derivative", new="proportional - derivative")
    assert "differs" in changed.said


def test_a_runner_is_asked_where_it_wants_the_program(built, tmp_path):
    board = tmp_path / "board.py"
    board.write_text("import subprocess, sys\nsys.exit(subprocess.call(sys.argv[-2]))\n")
    run = (sys.executable, str(board), "{program}", "-v")
    made = built("-O2", run=run)
    assert (made.fault, made.run) == ("", run)
    # One that prints nothing has run nothing.
    assert built("-O2", run=("true",)).fault == FAILED
    lied = built("-O2", run=("sh", "-c", f"echo {SAME}; exit 3"))
    assert lied.fault == "the self-test ended with 3"


def test_a_board_of_ones_own(built):
    """Its start, its memory and its runner; a source at the end of the line is compiled with it."""
    words = (str(BOARD / "startup.c"), "-T", str(BOARD / "memory.ld"), "--specs=nosys.specs")
    tools = {"link": (*words, "-nostartfiles"), "run": (*EMULATOR, "{program}")}
    made = built(*CORTEX, "-O2", cc="arm-none-eabi-gcc", **tools)
    assert (made.fault, made.link, made.emulated) == ("", tools["link"], False)


def test_what_does_not_fit_is_an_error(built, exported, tmp_path):
    with pytest.raises(NrsDesignError, match="does not compile with these flags") as caught:
        built(cc="arm-none-eabi-gcc")
    assert "-mcpu=cortex-m4" in caught.value.remedy
    with pytest.raises(NrsDesignError, match=r"error: .* target: cortex-m44 "):
        built("-mcpu=cortex-m44", cc="arm-none-eabi-gcc")
    assert built("-O2", "-c").fault == "linking made no program: leave -c, -S and -E out"
    with pytest.raises(NrsDesignError, match="cannot be run here") as caught:
        built(*CORTEX, cc="arm-none-eabi-gcc", link=("--specs=nosys.specs",), run=("{program}",))
    assert built("-O2", link=("-lnothing",)).fault == "the self-test does not link"
    write = [file for file in exported.iterdir() if "_test" not in file.name]
    with pytest.raises(NrsDesignError, match=r"holds no soft-tissue_test\.c"):
        build_binary(exported, write, NAMES, Toolchain(("gcc",)), silent)


def test_a_record_says_what_was_done_and_what_was_not(exported, sampled, sampled_export, tmp_path):
    folder = shutil.copytree(exported, tmp_path / "firmware")
    (folder / "main.c").write_text("")
    certificate = sampled_export.certificate
    found = compare_deployed(folder, sampled.spec, certificate)

    def recorded(*flags):
        tools = Toolchain(("gcc", *flags))
        made = build_binary(folder, found.compared, NAMES, tools, silent)
        return write_record(folder, binary_document(certificate, found, tools, made))

    file, changed = recorded("-O2")
    assert (file.name, changed) == ("soft-tissue.binary.json", ())
    text = file.read_text()
    document = json.loads(text)
    assert document["compile"] == ["gcc", "-O2"]
    assert document["certificate"] == certificate.id
    assert document["result"] == SAME
    assert set(document["compared"]) == {file.name for file in found.compared}
    assert "main.c: no export" in document["not_compared"]
    assert not any("silicon" in line for line in document["not_compared"])
    assert str(tmp_path) not in text
    # The same again is the same file; another flag is told, and is in the record.
    assert recorded("-O2") == (file, ())
    assert file.read_text() == text
    assert recorded("-O1")[1] == ("compile", "compiled")
    file.write_text("mine")
    with pytest.raises(OutputError, match="not overwritten"):
        recorded("-O2")
