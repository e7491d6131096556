"""Commands, rules, library and schemas as the documentation lists them."""

import json
import types

import pytest
import typer
from making.commands import commands_page
from making.commands import silent as silent_names
from making.faults import DocumentationError, refuse
from making.library import library_page
from making.rules import rules_page
from making.schemas import schema_names, schema_text, schemas_page
from typer.main import get_command

import nrs_design
from nrs_design.cli.app import make_app
from nrs_design.gating.rules import RULES, WORDS


def test_every_command_and_option_is_listed():
    page = commands_page()
    for name, command in get_command(make_app()).commands.items():
        assert f"`nrs-design {name}`" in page
        for parameter in command.params:
            assert parameter.help.split("\n")[0].split(" [")[0][:20] in page


def test_an_option_without_help_stops_the_build():
    app = typer.Typer()

    @app.command(help="Does nothing.")
    def silent(times: int = 1) -> None: ...

    @app.command()
    def mute() -> None: ...

    made = get_command(app)
    made.help, made.params = "Help.", []
    with pytest.raises(DocumentationError, match="p mute, p silent times"):
        refuse("without help", silent_names(made, "p"))


def test_every_rule_and_verdict_is_listed():
    page = rules_page()
    assert all(f"## {rule.id}: {rule.title}\n" in page for rule in RULES.values())
    assert all(f"## {word.word}\n" in page for word in WORDS.values())


def test_the_library_is_listed_where_it_is_defined():
    page = library_page()
    assert page.count(":::") == len(nrs_design.__all__)
    assert "::: nrs_design.api.matrices.certify" in page


def test_a_public_name_without_docstring_stops_the_build():
    class Silent:
        """Says something."""

        def says(self):
            pass

        @property
        def shown(self):
            pass

    package = types.ModuleType("package")
    package.__all__ = ["Silent", "mute"]
    package.Silent, package.mute = Silent, lambda: None
    with pytest.raises(DocumentationError, match=r"Silent\.says, Silent\.shown, mute"):
        library_page(package)


def test_every_schema_is_there_as_a_file_and_in_words():
    texts = {name: schema_text(name) for name in schema_names()}
    assert {"spec", "export"} <= texts.keys()
    assert all(json.loads(text)["$schema"] for text in texts.values())
    page = schemas_page(texts)
    for name in texts:
        assert f"[{name}.schema.json]({name}.schema.json)" in page
    assert all(f"| `{key}` |" in page for key in json.loads(texts["export"])["properties"])
