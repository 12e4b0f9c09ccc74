"""The demo as its user meets it: the command, its page in a real browser, keys, plots and downloads."""

from collections.abc import Callable
from typing import Any


def test_an_operator_drives_plots_and_downloads_in_a_real_browser(demo: str, browse: Callable[..., Any]) -> None:
    browse("operate.mjs", demo)
