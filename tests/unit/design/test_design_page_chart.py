"""The fixtures that hold the page's load chart and masses to this package's are what this package computes."""

from __future__ import annotations

import json

import chart_fixture
import numpy as np
import parts_fixture


def test_the_loads_for_the_page_are_up_to_date() -> None:
    """If not: run `python tests/unit/design/chart_fixture.py` and `npm run format`."""
    written, now = (json.loads(t) for t in (chart_fixture.FILE.read_text("utf-8"), chart_fixture.content()))
    assert [case["crane"] for case in written] == [case["crane"] for case in now]
    for old, new in zip(written, now, strict=True):
        for key in ("radius", "height"):
            np.testing.assert_allclose(old[key], new[key], atol=1e-11)
        for mode in new["modes"]:
            np.testing.assert_allclose(old["modes"][mode]["load"], new["modes"][mode]["load"], rtol=1e-11, atol=1e-6)
            assert old["modes"][mode]["governs"] == new["modes"][mode]["governs"]


def test_the_masses_for_the_page_are_up_to_date() -> None:
    """If not: run `python tests/unit/design/parts_fixture.py` and `npm run format`."""
    written, now = (json.loads(t) for t in (parts_fixture.FILE.read_text("utf-8"), parts_fixture.content()))
    assert [(case["crane"], case["links"]) for case in written] == [(case["crane"], case["links"]) for case in now]
    for old, new in zip(written, now, strict=True):
        for link, bodies in new["bodies"].items():
            for a, b in zip(old["bodies"][link], bodies, strict=True):
                assert (a["name"], a["vertices"], a["faces"]) == (b["name"], b["vertices"], b["faces"])
                np.testing.assert_allclose(a["mass"], b["mass"], rtol=1e-11)
                np.testing.assert_allclose(a["inertia"], b["inertia"], atol=1e-11 * max(b["inertia"]))
