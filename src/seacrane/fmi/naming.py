"""The naming conventions for variables (FMI 2.0, section 2.2.9)."""

from __future__ import annotations

import re
from typing import Final

_PLAIN = r"[A-Za-z_][A-Za-z_0-9]*"
_QUOTED = r"""'(?:[A-Za-z_0-9!#$%&()*+,\-./:;<>=?@\[\]^{}|~ ]|\\['"?\\abfnrtv])+'"""
_BASE = rf"(?:{_PLAIN}|{_QUOTED})(?:\[\d+(?:,\d+)*\])?"
_IDENTIFIER = rf"{_BASE}(?:\.{_BASE})*"
_STRUCTURED: Final = re.compile(rf"{_IDENTIFIER}|der\({_IDENTIFIER}(?:,\d+)?\)")


def is_structured(name: str) -> bool:
    """Whether a name keeps the structured convention: `a.b[1].'free text'` or `der(x)`."""
    return _STRUCTURED.fullmatch(name) is not None


def is_flat(name: str) -> bool:
    """Whether a name keeps the flat convention: any text on one line without tabs."""
    return not set(name) & set("\r\n\t")
