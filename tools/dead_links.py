"""Links of a built site that lead nowhere inside of it; `make docs` calls this.

Links to other sites are left alone: nothing is looked up in the network.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """What a page links to, and where on it links can lead.

    Args:
        path: The HTML file.
    """

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.path = path.resolve()
        self.targets: set[str] = set()
        self.places: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take links and places of an element."""
        for name, value in attrs:
            if name in {"href", "src"} and value:
                self.targets.add(value)
            elif name in {"id", "name"} and value:
                self.places.add(value)


def dead_links(site: Path) -> list[str]:
    """Find the links that lead nowhere.

    Args:
        site: Folder of the built pages.

    Returns:
        A line for each: the page and the link.
    """
    pages = {page.path: page for page in map(Page, sorted(site.rglob("*.html")))}
    return [
        f"{path.relative_to(site.resolve())}: {target}"
        for path, page in pages.items()
        for target in sorted(page.targets)
        if not all(_leads(place, fragment, pages) for place, fragment in _inside(path, target))
    ]


def _inside(path: Path, target: str) -> Iterator[tuple[Path, str]]:
    """File and place that a link inside the site leads to; nothing for other links."""
    parts = urlsplit(target)
    if not parts.scheme and not parts.netloc:
        to = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        yield (to / "index.html" if to.is_dir() else to), unquote(parts.fragment)


def _leads(place: Path, fragment: str, pages: dict[Path, Page]) -> bool:
    if not fragment or place not in pages:
        return place.is_file()
    return fragment in pages[place].places


def main(site: str) -> int:
    """Print the dead links of a site; return the exit code."""
    found = dead_links(Path(site))
    for line in found:
        print(f"error: dead link: {line}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
