"""Text on its way out: to terminals and figures without control characters, to HDF5 without what it cannot hold.

visible     what a terminal or a figure may show: control characters, line ends and bytes that are no UTF-8 become escapes, as `\\x1b`
storable    what a dataset may hold: NUL and halves of surrogate pairs become escapes
figure      a number to the second digit of its error; amount: with it
joined      text of a config: pairs of surrogates become the letter that they stand for; ValueError for NUL and for half a pair
"""

import math
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


def figure(value: float, error: float) -> str:
    """A number to the second digit of its error: `13.82`, `231000`, `2.31e+09`."""
    if not math.isfinite(error) or error <= 0 or not math.isfinite(value):
        return f"{value:.6g}"
    places = 1 - math.floor(math.log10(error))
    value = round(value, places)
    if value and not 1e-4 <= abs(value) < 1e7:
        return f"{value:.{max(0, places + math.floor(math.log10(abs(value))))}e}"
    return f"{value:.{max(0, places)}f}"


def amount(value: float, error: float) -> str:
    """`0.41 ± 0.11`: two digits of the error."""
    return figure(value, error) + (f" ± {figure(error, error)}" if math.isfinite(error) and error > 0 else "")
