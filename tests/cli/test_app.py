"""The program itself: help, version, and how errors end."""

import json
import os
import sys

import pytest
from typer.main import get_command

from nrs_design import __version__
from nrs_design.cli.app import COMMANDS, make_app
from nrs_design.proof.evidence import KINDS
from tests.support import COMMUTING, ROOT, SOFT_TISSUE, run, started, thinned, typed


def test_version(tmp_path):
    assert typed("--version", cwd=tmp_path).stdout == f"nrs-design {__version__}\n"


@pytest.mark.parametrize("arguments", [["--help"], ["--help", "verify"]])
def test_help_lists_every_command_and_exit_code(tmp_path, arguments):
    text = run(*arguments, cwd=tmp_path).stdout
    assert all(command in text for command in COMMANDS)
    assert "0 proved or goal met" in " ".join(text.split())


@pytest.mark.parametrize("command", [c.name for c in make_app().registered_commands])
def test_every_command_has_an_example(tmp_path, command):
    result = run(command, "--help", cwd=tmp_path, code=0)
    assert f"nrs-design {command}" in " ".join(result.stdout.split()), result.stdout


def loaded_by(tmp_path, *arguments, **environment):
    """Run a command; return its process and what it has imported and set."""
    program = (
        "import json, os, sys\n"
        "from nrs_design.cli import main\n"
        "try: main()\n"
        "finally:\n"
        "    names = ('OPENBLAS_NUM_THREADS', 'PYDANTIC_DISABLE_PLUGINS')\n"
        "    facts = {'modules': sorted(sys.modules), **{n: os.environ[n] for n in names}}\n"
        "    print(json.dumps(facts), file=sys.stderr)"
    )
    result = started("-c", program, *arguments, cwd=tmp_path, **environment)
    return result, json.loads(result.stderr.splitlines()[-1])


def test_only_the_command_asked_for_is_imported(tmp_path):
    result, facts = loaded_by(tmp_path, "verify", "--help")
    assert result.returncode == 0
    commands = {f"nrs_design.cli.{name.replace('-', '_')}" for name in COMMANDS}
    assert commands & set(facts["modules"]) == {"nrs_design.cli.verify"}


@pytest.mark.parametrize("arguments", [("--help",), ("tune", "--help")])
def test_help_loads_no_part_of_a_design(tmp_path, arguments):
    _, facts = loaded_by(tmp_path, *arguments)
    rooms = {name.split(".")[1] for name in facts["modules"] if name.startswith("nrs_design.")}
    assert not {"pipeline", "design", "loop"} & rooms


# What checks a certificate by itself: the program, the file format, the proof; and the series of
# the second opinion on exponentials.
CHECKING = (
    *("cli", "controllers", "certificates", "proof", "models"),
    *("errors", "files", "printable", "wings"),
)
MOST_MODULES = 42


SHIPPED = sorted(path.name for path in (ROOT / "reports").glob("*.cert.json"))
SHIPPED[3:] = [pytest.param(name, marks=pytest.mark.nightly) for name in SHIPPED[3:]]


@pytest.mark.parametrize("name", SHIPPED)
def test_verify_loads_the_proof_and_the_file_format_alone(tmp_path, name):
    result, facts = loaded_by(tmp_path, "verify", ROOT / "reports" / name)
    assert result.returncode in (0, 1), result.stderr
    ours = [module.split(".") for module in facts["modules"] if module.startswith("nrs_design")]
    assert {parts[1] for parts in ours if len(parts) > 1} <= set(CHECKING)
    assert len(ours) <= MOST_MODULES, ours


def test_verify_beside_a_spec_loads_no_heavy_library(tmp_path):
    given = (ROOT / "reports/soft-tissue.cert.json", SOFT_TISSUE)
    result, facts = loaded_by(tmp_path, "verify", *given)
    assert result.returncode == 0
    heavy = {"control", "cvxpy", "scipy", "matplotlib", "clarabel", "numpy", "jinja2"}
    assert not heavy & set(facts["modules"])


def test_a_design_without_a_proof_loads_no_part_of_one(tmp_path):
    result, facts = loaded_by(tmp_path, "optimize", SOFT_TISSUE)
    assert result.returncode == 0
    ours = [name.split(".")[1:2] for name in facts["modules"] if name.startswith("nrs_design")]
    assert ["certificates"] not in ours
    assert ["search"] not in ours
    assert len(ours) <= 190, ours


def test_an_easy_proof_loads_one_search_and_neither_a_solver_nor_a_design(tmp_path):
    result, facts = loaded_by(tmp_path, "certify-switching", COMMUTING, "--no-optimize-rate")
    assert result.returncode == 0, result.stderr
    modules = set(facts["modules"])
    assert not {"scipy", "clarabel", "control", "cvxpy", "matplotlib"} & modules
    # The models of all parts of a design take a tenth of a second.
    assert "nrs_design.spec.switched_system" in modules
    assert not {"nrs_design.spec.interaction", "nrs_design.spec.goals"} & modules
    kinds = {kind.replace("-", "_") for kind in KINDS}
    loaded = {name.removeprefix("nrs_design.proof.evidence.") for name in modules}
    assert kinds & loaded == {"graph", "growing_sequence"}
    for needless in ("period", "invariant_ellipsoid", "saturated_ellipsoid", "gradient"):
        assert f"nrs_design.search.{needless}" not in modules


@pytest.mark.slow
def test_settings_of_libraries_are_defaults_only(tmp_path):
    _, facts = loaded_by(tmp_path, "--version", OPENBLAS_NUM_THREADS="3")
    assert (facts["OPENBLAS_NUM_THREADS"], facts["PYDANTIC_DISABLE_PLUGINS"]) == ("1", "__all__")


@pytest.mark.parametrize("verbose", [(), ("-v",)])
def test_a_defect_is_exit_code_4(tmp_path, verbose):
    """The message says how to show more, also where the command itself has no -v."""
    program = (
        "import nrs_design.spec as s\n"
        "def fail(path): raise ZeroDivisionError('boom')\n"
        "s.read_spec = fail\n"
        "from nrs_design.cli import main; main()"
    )
    result = started("-c", program, *verbose, "tune", COMMUTING, cwd=tmp_path)
    assert (result.returncode, result.stdout) == (4, "")
    assert "internal error: ZeroDivisionError: boom" in result.stderr
    assert "run it again as `nrs-design -v ...`" in result.stderr
    assert ("Traceback" in result.stderr) == bool(verbose)


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [("KeyboardInterrupt", 130, ""), ("MemoryError", 2, "error: there is not enough memory")],
)
@pytest.mark.parametrize("module", ["typer", "nrs_design.cli.verify", "flint"])
def test_what_falls_into_an_import_ends_as_elsewhere(tmp_path, module, error, code, said):
    program = (
        "import sys\n"
        "class Finder:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        f"        if name == '{module}': raise {error}\n"
        "sys.meta_path.insert(0, Finder())\n"
        "from nrs_design.cli import main; main()"
    )
    certificate = ROOT / "reports" / "commuting.cert.json"
    result = started("-c", program, "verify", "--json", certificate, cwd=tmp_path)
    assert (result.returncode, result.stderr[: len(said)]) == (code, said)
    assert result.stderr.count("\n") == bool(said)


@pytest.mark.skipif(sys.platform != "linux", reason="limits are those of Linux")
def test_too_little_memory_is_no_verdict(tmp_path):
    """Under 120,000 KiB OpenBLAS ended the program with 1, which says that a spec is refuted."""
    limited = f'ulimit -v 120000; exec "{sys.executable}" -m nrs_design "$@"'
    command = ("bash", "-c", limited, "bash", "certify-switching", COMMUTING)
    done = started(*command, cwd=tmp_path, python=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert (
        done.stderr == "error: 117 MiB of memory are allowed, and 512 MiB are needed (ulimit -v)\n"
    )


def test_as_a_module_it_imports_nothing_from_the_working_folder(tmp_path):
    for name in ("typer", "rich", "ruamel", "json", "pydantic", "numpy"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('taken over')")
    result = started("-m", "nrs_design", "certify-switching", COMMUTING, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "taken over" not in result.stderr


def test_what_cannot_be_loaded_is_exit_code_4(tmp_path):
    broken = tmp_path / "broken"
    broken.mkdir()
    (broken / "typer.py").write_text("raise ImportError('half\\ninstalled')")
    path = f"{broken}{os.pathsep}{ROOT}"
    result = started("-m", "nrs_design", "--version", cwd=tmp_path, PYTHONPATH=path)
    assert result.returncode == 4
    assert result.stderr.count("\n") == 1
    assert "cannot be loaded" in result.stderr


def test_a_warning_of_a_library_is_no_verdict(tmp_path):
    program = (
        "import warnings, nrs_design.spec as s\n"
        "read = s.read_spec\n"
        "def noisy(path): warnings.warn('old', DeprecationWarning); return read(path)\n"
        "s.read_spec = noisy\n"
        "from nrs_design.cli import main; main()"
    )
    result = started("-W", "error", "-c", program, "certify-switching", COMMUTING, cwd=tmp_path)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize(
    "spec", thinned(["::error::\u202e\x1b[31m\n.nrs.yaml", "a\udcff.nrs.yaml"], 1)
)
def test_a_hostile_file_name_is_shown_and_changes_no_exit_code(tmp_path, spec):
    (tmp_path / spec).write_bytes(COMMUTING.read_bytes())
    program = ("-m", "nrs_design")
    for command, expected in (("check", 0), ("certify-switching", 0), ("verify", 2)):
        arguments = [spec] * (2 if command == "verify" else 1)
        result = started(*program, command, *arguments, cwd=tmp_path, PYTHONIOENCODING="ascii")
        assert result.returncode == expected, result.stderr
        for line in (result.stdout + result.stderr).split("\n"):
            assert line.isprintable()
            assert not line.strip().startswith("::")


# What all commands have.
SHARED = {"help", "as_json", "quiet", "verbose"}


def test_a_command_has_twelve_options_at_most():
    def options(command):
        inner = getattr(command, "commands", {}).values()
        own = [p for p in command.params if p.param_type_name == "option" and p.name not in SHARED]
        if not inner:
            yield command.name, len(own)
        for item in inner:
            yield from options(item)

    assert {name: count for name, count in options(get_command(make_app())) if count > 12} == {}
