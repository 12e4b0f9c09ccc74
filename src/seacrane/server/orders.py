"""Messages from the server to its simulation process: typed JSON, one datagram each, over a private socket pair."""

from __future__ import annotations

from typing import Final

import msgspec

DATAGRAM: Final = 65536
"""Largest message [bytes]."""


class Command(msgspec.Struct, frozen=True, tag=True):
    """Where the axes stand; lapses to zero unless renewed."""

    axes: dict[str, float]
    deadman: bool


class Pause(msgspec.Struct, frozen=True, tag=True):
    """Let simulated time stand still."""

    number: int


class Resume(msgspec.Struct, frozen=True, tag=True):
    """Let simulated time run."""

    number: int


class Reset(msgspec.Struct, frozen=True, tag=True):
    """Build anew and start at time zero, running if it was."""

    number: int


class Stop(msgspec.Struct, frozen=True, tag=True):
    """Free the simulation and end."""


Order = Command | Pause | Resume | Reset | Stop

encode = msgspec.json.Encoder().encode
decode = msgspec.json.Decoder(Order).decode
