"""Text on its way out: to terminals and figures without control characters, to HDF5 without what it cannot hold.

visible     what a terminal or a figure may show: control characters, line ends and bytes that are no UTF-8 become escapes, as `\\x1b`
storable    what a dataset may hold: NUL and halves of surrogate pairs become escapes
joined      text of a config: pairs of surrogates become the letter that they stand for; ValueError for NUL and for half a pair
"""

import re
import unicodedata

UNSTORABLE = re.compile("[\0\ud800-\udfff]")
JOINERS = "\u200c\u200d"  # letters and emoji are joined by them


def escaped(letter: str) -> str:
    """`\\x1b`, `\\u2028`; a byte of a file name that is no UTF-8 as that byte."""
    code = ord(letter)
    return f"\\x{code - 0xDC00:02x}" if 0xDC80 <= code <= 0xDCFF else letter.encode("unicode_escape").decode("ascii")


def visible(text: str, keep: str = "") -> str:
    """The text with an escape in the place of every letter that shows nothing, or that does something; `keep`: but for these."""
    if text.isprintable():
        return text
    shown = keep + JOINERS
    return "".join(letter if letter.isprintable() or letter in shown or unicodedata.category(letter) == "Zs" else escaped(letter) for letter in text)


def storable(text: str) -> str:
    """The text with an escape in the place of NUL and of half a surrogate pair."""
    return UNSTORABLE.sub(lambda found: escaped(found[0]), text)


def joined(text: str) -> str:
    """The text with whole letters in the place of surrogate pairs, as JSON writes them; ValueError for what no file can hold."""
    if text.isascii() and "\0" not in text:
        return text
    whole = text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")
    if found := UNSTORABLE.search(whole):
        raise ValueError("a NUL character" if found[0] == "\0" else f"half of a surrogate pair, {escaped(found[0])}")
    return whole
