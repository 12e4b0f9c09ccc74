"""How parallel workers share the tests.

A worker takes a whole file. What runs by the clock or in a browser stays on one worker, one after the other: two at
once would rob each other of their time.
"""

from __future__ import annotations

import pytest
from xdist.scheduler import LoadFileScheduling

BY_THE_CLOCK = ("tests/contract/", "tests/e2e/", "tests/unit/server/")


class Sharing(LoadFileScheduling):
    """Shares by file, but for what runs by the clock."""

    def _split_scope(self, nodeid: str) -> str:
        return "by the clock" if nodeid.startswith(BY_THE_CLOCK) else super()._split_scope(nodeid)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> Sharing:
    return Sharing(config, log)
