"""Pages load nothing from a network: whoever reads them in an operating room has none."""

from __future__ import annotations

from html.parser import HTMLParser

# What a browser fetches by itself; a link that a reader may follow is another thing.
LOADED = {
    "script": "src",
    "img": "src",
    "iframe": "src",
    "source": "src",
    "video": "src",
    "audio": "src",
    "object": "data",
    "link": "href",
}
RELATIONS = {"stylesheet", "icon", "shortcut", "preload", "modulepreload", "manifest"}


class _Loaded(HTMLParser):
    """Collects what a page loads from elsewhere."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note the address, if the browser fetches it from a host."""
        given = dict(attrs)
        address = given.get(LOADED.get(tag, "")) or ""
        wanted = tag != "link" or RELATIONS & {*(given.get("rel") or "").split()}
        if wanted and address.lower().startswith(("http:", "https:", "//")):
            self.found.append(address)


def loaded_from_elsewhere(html: str) -> list[str]:
    """Return the addresses on other hosts that a page loads."""
    parser = _Loaded()
    parser.feed(html)
    return parser.found
