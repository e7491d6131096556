import json
import subprocess
import sys

import pytest

from nrs_design.cli import main
from nrs_design.gating.rules import RULES, WORDS


@pytest.fixture
def explain(monkeypatch):
    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["nrs-design", "explain", *arguments])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0)

    return run


@pytest.mark.parametrize("name", [*RULES, *WORDS, "nrs102", "PROVED"])
def test_one_entry(explain, capsys, name):
    assert explain(name) == 0
    out = capsys.readouterr().out
    entry = RULES.get(name.upper()) or WORDS[name.lower()]
    said = " ".join(out.split())
    assert entry.explanation in said
    assert entry.remedy in said
    assert max(map(len, out.split("\n"))) <= 88


def test_list(explain, capsys):
    assert explain() == 0
    out = capsys.readouterr().out
    assert all(f"{rule.id}  {rule.title}\n" in out for rule in RULES.values())
    assert all(word in out for word in WORDS)


def test_json(explain, capsys):
    assert explain("--json") == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "nrs-design/explain/1"
    assert [rule["id"] for rule in document["rules"]] == list(RULES)
    assert explain("inconclusive", "--json") == 0
    assert json.loads(capsys.readouterr().out)["word"] == "inconclusive"


@pytest.mark.parametrize("name", ["NRS999", "", "maybe", "\x1b[31m"])
def test_unknown(explain, capsys, name):
    assert explain(name) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "there is no rule or verdict" in err
    assert "\x1b" not in err


def test_explaining_needs_no_numerical_library():
    program = (
        "import sys\nfrom nrs_design.cli import main\nsys.argv = ['nrs-design', 'explain']\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print('LOADED', sorted({'numpy', 'scipy', 'control', 'flint'} & set(sys.modules)))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.endswith("LOADED []\n")
