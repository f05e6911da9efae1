"""Sections of docs/trouble.md and docs/glossary.md by the words in their headings."""

import re

from mpm.reference.entry import Entry
from mpm.starting.places import folder

PAGES = {"trouble": "cause and cure", "glossary": "term"}


def entries() -> list[Entry]:
    """A section each, found by what stands in backticks in its heading, or by the heading itself. A heading may name several words."""
    found = []
    for page, what in PAGES.items():
        text = (folder("docs") / f"{page}.md").read_text(encoding="utf-8")
        for heading, body in re.findall(r"^### (.+)\n\n((?:(?!^#).*\n?)*)", text, re.MULTILINE):
            words = re.findall(r"`([^`]+)`", heading) or [part.strip() for part in heading.split(",")]
            first, _, rest = body.strip().partition("\n\n")
            found += [Entry(word, what, " ".join(first.split()), more=rest.strip()) for word in words]
    return found
