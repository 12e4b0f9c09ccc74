"""What is compiled once is not compiled again, and what has changed is."""

from __future__ import annotations

import ctypes
from pathlib import Path

import pytest

from seacrane import design, plant
from seacrane.model.codegen import generate
from seacrane.native import build_library

HALF = '#include "numbers.h"\n__attribute__((visibility("default"))) double half(void) { return NUMBER / 2; }\n'
ONE = '#include "inner.h"\n__attribute__((visibility("default"))) double one(void) { return INNER; }\n'
SOURCES = {
    "half.c": HALF,
    "one.c": ONE,
    "numbers.h": '#include "inner.h"\n#define NUMBER (2 * INNER)\n',
    "inner.h": "#define INNER 3.0\n",
    "unused.h": "",
}


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return tmp_path / "seacrane"


def called(path: Path, function: str) -> float:
    library = ctypes.CDLL(str(path))
    getattr(library, function).restype = ctypes.c_double
    value: float = getattr(library, function)()
    return value


def test_only_files_that_have_changed_or_include_what_has_are_compiled_again(cache: Path) -> None:
    def objects() -> int:
        return len(list((cache / "objects").glob("*.o")))

    first = build_library("numbers", SOURCES)
    assert (called(first, "half"), called(first, "one")) == (3.0, 3.0)
    assert objects() == 2
    other = build_library("numbers", SOURCES | {"one.c": ONE.replace("return", "return 10 +")})
    assert (called(other, "half"), called(other, "one")) == (3.0, 13.0)
    assert objects() == 3
    build_library("numbers", SOURCES | {"unused.h": "#define A 1\n"})
    assert objects() == 3
    inner = build_library("numbers", SOURCES | {"inner.h": "#define INNER 5.0\n"})
    assert (called(inner, "half"), called(inner, "one")) == (5.0, 5.0)
    assert objects() == 5
    assert not [path for path in (cache / "objects").iterdir() if path.suffix != ".o"], "nothing half-written is left"


def test_a_crane_in_another_posture_with_another_load_has_the_same_equations_in_c() -> None:
    crane = design.load("a-frame-30t")
    one = plant.Start.usual(crane)
    starts = (one, plant.Start.usual(crane, {"luff": 1.2, "telescope": 0.7}, 0.5 * one.load))
    first, second = (generate(plant.parts(crane, start=start)["crane"]).sources for start in starts)
    assert {name for name in first if first[name] != second[name]} == {"model_tables.c", "model_guid.h"}
