"""Entry: one word, what it is, what it means, and facts about it."""

from dataclasses import dataclass, field

WIDTH = 14


@dataclass(frozen=True)
class Entry:
    """`word` as a user meets it, `what` it is (key, kind, outcome, ...), `text` what it means, `facts` in the order in which they are shown."""

    word: str
    what: str
    text: str
    facts: dict[str, str] = field(default_factory=dict)
    more: str = ""  # whole paragraphs, as Markdown

    def said(self) -> str:
        """For a terminal."""
        lines = [f"{self.word}  ({self.what})", f"  {self.text}"]
        lines += [f"  {name:<{WIDTH}}{value}" for name, value in self.facts.items() if value]
        return "\n".join(lines + (["", self.more] if self.more else []))

    def cells(self, *names: str) -> str:
        """A row of a Markdown table: the word, then these facts; `text` is one of the names."""
        values = [self.text if name == "text" else self.facts.get(name, "") for name in names]
        return "| " + " | ".join([f"`{self.word}`", *(value.replace("|", "\\|").replace("\n", " ") for value in values)]) + " |"
