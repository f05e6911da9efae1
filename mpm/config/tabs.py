"""Tabs where YAML 1.2 allows them (its sections 6.1 to 6.3), which ruamel.yaml refuses: between what stands on a line, inside words, at the end of a
line, and before the words of a value that is indented enough already. A tab that would indent is an error that says so."""

import re
from typing import Any

from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.scanner import Scanner

BREAKS = "\r\n\x85\u2028\u2029"
HEADER = re.compile(r"[-+\d]*[ \t]*")  # after the | or > of a block scalar
BLANK = re.compile(r"(?:[ \t]*(?:\r\n|\r|\n))*")
SPACES, WHITE = re.compile(" *"), re.compile(r"[ \t]*")


def end(pattern: re.Pattern[str], text: str, begin: int) -> int:
    """Where what a pattern finds at a place ends; at the place itself where that is nothing."""
    found = pattern.match(text, begin)
    return found.end() if found else begin


class TabScanner(Scanner):
    """ruamel's scanner, with tabs."""

    tab: Any = None  # the mark of a tab that stands where a block's line could be indented

    def scan_to_next_token(self) -> None:
        """Spaces, tabs, comments and line ends. In a block, what follows a tab begins no mapping or sequence: its column would have no meaning."""
        reader = self.reader
        if reader.index == 0 and reader.peek() == "\ufeff":
            reader.forward()
        if self.tab is not None and self.tab.line != reader.line:
            self.tab = None
        while True:
            while reader.peek() in " \t":
                if reader.peek() == "\t" and not self.flow_level:
                    self.allow_simple_key = False
                    if self.tab is None and not reader.buffer[reader.pointer - reader.column : reader.pointer].strip(" -?"):
                        self.tab = reader.get_mark()
                reader.forward()
            if reader.peek() == "#":
                while reader.peek() not in BREAKS + "\0":
                    reader.forward()
            if not self.scan_line_break():
                break
            self.tab, self.allow_simple_key = None, self.allow_simple_key or not self.flow_level
        if self.tab is not None and self.tab.column <= self.indent and reader.peek() != "\0":
            before = reader.buffer[reader.pointer - reader.column : reader.pointer]
            if not before.strip():
                raise self.indented()

    def indented(self) -> MarkedYAMLError:
        """What to say of a tab that would indent."""
        return MarkedYAMLError(problem="a tab does not indent: use spaces", problem_mark=self.tab)

    def fetch_value(self) -> None:
        """A mapping's value; a tab before its key makes it none."""
        if self.tab is not None and not self.allow_simple_key and self.flow_level not in self.possible_simple_keys:
            raise self.indented()
        super().fetch_value()

    def fetch_block_entry(self) -> None:
        """An entry of a sequence; not after a tab."""
        if self.tab is not None:
            raise self.indented()
        super().fetch_block_entry()

    def scan_plain_spaces(self, indent: Any, start_mark: Any) -> Any:
        """What lies between the words of a plain scalar: tabs are a part of it on a line, and as spaces where it goes on in the next."""
        reader = self.reader
        length = 0
        while reader.peek(length) in " \t":
            length += 1
        between = reader.prefix(length)
        reader.forward(length)
        if reader.peek() not in BREAKS:
            return [between] if between else []
        begin = end(BLANK, reader.buffer, reader.pointer)
        words = end(SPACES, reader.buffer, begin)
        self.spaced(reader.pointer, end(WHITE, reader.buffer, words) if self.flow_level or words - begin >= indent else begin)
        return super().scan_plain_spaces(indent, start_mark)

    def scan_block_scalar_indicators(self, start_mark: Any) -> Any:
        """What follows `|` or `>` on its line."""
        self.spaced(self.reader.pointer, end(HEADER, self.reader.buffer, self.reader.pointer))
        return super().scan_block_scalar_indicators(start_mark)

    def spaced(self, first: int, last: int) -> None:
        """Spaces for tabs between two places that are not read yet."""
        buffer = self.reader.buffer
        if "\t" in (part := buffer[first:last]):
            self.reader.buffer = buffer[:first] + part.replace("\t", " ") + buffer[last:]
