"""Every command on every hostile input: its exit code, time, memory, words, and what it touches."""

import os

import pytest

from nrs_design.gating.lock import Lock, dump_lock
from tests.hostile.corpus import CERTIFICATES, LOCKS, NAMES, RECORDS, SPECS, write
from tests.hostile.running import check
from tests.support import COMMUTING
from tests.tables import rows

SPEC_COMMANDS = [tuple(line.split()) for line in rows(__file__, "SPEC_COMMANDS")]

# What takes seconds to read and is refused then, by one reader for all commands: one that prints
# the fault, one that lists it, and one that goes on to the next file show what there is to see, and
# only when everything is looked at.
LONG = ("list of 80,000", "unknown keys", "many words", "spaces")
READERS = (SPEC_COMMANDS[0], SPEC_COMMANDS[1], SPEC_COMMANDS[9])


def slow_if(case, among):
    return pytest.param(case, marks=pytest.mark.slow) if case in among else case


# What takes seconds to write and to read; the others show the same of a thinner one.
LARGE = ("a million columns", "text of a mebibyte", "column of a mebibyte", "300,000 entries")


@pytest.fixture
def place(tmp_path, monkeypatch):
    for name in ("work", "home", "outside"):
        (tmp_path / name).mkdir()
    (tmp_path / "outside" / "precious.html").write_text("mine")
    monkeypatch.chdir(tmp_path / "work")
    return tmp_path


@pytest.mark.parametrize("case", [case for case in SPECS if case not in (*LONG, "corners")])
def test_a_spec_is_checked(place, case):
    write(place / "work/spec.nrs.yaml", SPECS[case]())
    check(place, "check", "spec.nrs.yaml")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "command"),
    [
        pytest.param(case, command, id=f"{case}-{' '.join(command)}")
        for case in SPECS
        for command in (READERS if case in LONG else SPEC_COMMANDS)
    ],
)
def test_a_spec_in_every_command(place, case, command):
    write(place / "work/spec.nrs.yaml", SPECS[case]())
    write(place / "work/nrs.lock", dump_lock(Lock(specs=[])))
    check(place, *command, "spec.nrs.yaml")


@pytest.mark.parametrize("case", [slow_if(case, LARGE) for case in RECORDS])
@pytest.mark.parametrize(
    "command",
    [
        pytest.param(("identify", "tissue", "--json"), marks=pytest.mark.slow),
        ("identify", "tissue", "--report", "page.html"),
        pytest.param(("identify", "actuator"), marks=pytest.mark.slow),
    ],
    ids=" ".join,
)
def test_a_record(place, case, command):
    write(place / "work/data.csv", RECORDS[case]())
    check(place, *command, "data.csv", codes=(2,))


@pytest.mark.parametrize("beside", [("spec.nrs.yaml",), pytest.param((), marks=pytest.mark.slow)])
@pytest.mark.parametrize("case", CERTIFICATES)
def test_a_certificate(place, case, beside):
    write(place / "work/spec.nrs.yaml", COMMUTING.read_bytes())
    write(place / "work/bogus.cert.json", CERTIFICATES[case]())
    check(place, "verify", "bogus.cert.json", *beside, codes=(1, 2))


@pytest.mark.parametrize("case", [slow_if(case, LARGE) for case in LOCKS])
def test_a_lock(place, case):
    write(place / "work/spec.nrs.yaml", COMMUTING.read_bytes())
    write(place / "work/nrs.lock", LOCKS[case]())
    check(place, "gate", "--locked", "spec.nrs.yaml", codes=(1, 2))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "command",
    [
        ("check",),
        ("gate", "--format", "github", "--no-reports"),
        *(pytest.param(c, marks=pytest.mark.slow) for c in SPEC_COMMANDS),
    ],
    ids=" ".join,
)
def test_a_file_name(place, name, command):
    write(place / "work" / name, COMMUTING.read_bytes())
    check(place, *command, "--", name)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes in folders")
@pytest.mark.parametrize("kind", ["pipe", "device", "loop"])
@pytest.mark.parametrize(
    "command",
    [
        ("check", "x"),
        ("gate", "x"),
        ("identify", "tissue", "x"),
        ("identify", "actuator", "x"),
        ("verify", "x", str(COMMUTING)),
        ("export", str(COMMUTING), "--certificate", "x"),
        ("gate", "--locked", "--lock", "x", str(COMMUTING)),
        ("init", "robot", "--out", "new.nrs.yaml"),
    ],
    ids=" ".join,
)
def test_what_is_no_file(place, command, kind):
    # `init` writes a file for editors, and leaves what lies in its place.
    is_schema = command[0] == "init"
    path = place / "work" / ("nrs.schema.json" if is_schema else "x")
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero" if kind == "device" else path)
    check(place, *command, codes=(0, 2) if is_schema else (2,))


@pytest.mark.parametrize("option", ["--reports", "--lock"])
def test_a_link_out_of_the_working_folder(place, option):
    write(place / "work/spec.nrs.yaml", COMMUTING.read_bytes())
    (place / "work/link").symlink_to(place / "outside")
    target = "link" if option == "--reports" else "link/nrs.lock"
    check(place, "gate", option, target, "spec.nrs.yaml")
