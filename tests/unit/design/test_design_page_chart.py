"""The fixture that holds the page's load chart to this package's is what this package computes."""

from __future__ import annotations

import json

import numpy as np
from chart_fixture import FILE, content


def test_the_fixture_of_the_page_is_up_to_date() -> None:
    """If not: run `python tests/unit/design/chart_fixture.py`."""
    written, now = (json.loads(text) for text in (FILE.read_text(encoding="utf-8"), content()))
    assert [case["crane"] for case in written] == [case["crane"] for case in now]
    for old, new in zip(written, now, strict=True):
        for key in ("radius", "height"):
            np.testing.assert_allclose(old[key], new[key], atol=1e-11)
        for mode in new["modes"]:
            np.testing.assert_allclose(old["modes"][mode]["load"], new["modes"][mode]["load"], rtol=1e-11, atol=1e-6)
            assert old["modes"][mode]["governs"] == new["modes"][mode]["governs"]
