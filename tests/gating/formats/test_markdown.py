import re
from html import unescape

from nrs_design.gating.formats import to_markdown
from tests.gating.formats.support import HOSTILE, obligation, outcome_of


def test_the_sum_comes_first_and_every_spec_has_a_row(mixed):
    lines = to_markdown(mixed).splitlines()
    assert unescape(lines[0]).startswith("### ❌ nrs-design: 3 specs: 1 refuted, 1 proved")
    assert unescape(lines[2]).startswith("- specs/c.nrs.yaml: NRS900 error")
    assert sum(line.startswith("| specs/") for line in lines) == 3


def test_what_strangers_wrote_is_no_markup():
    text = to_markdown(outcome_of(obligation(path=f"specs/{HOSTILE}", message="<b> @all [x](y)")))
    shown = text.replace("<details><summary>every spec</summary>", "").replace("</details>", "")
    assert not re.search(r"<|@|\]\(", shown)
    assert "<b> @all [x](y)" in unescape(text)
