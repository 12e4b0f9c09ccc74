"""The messages of a WebAssembly module are written by our own few lines, which must write what printf writes."""

import ctypes
import math
import random
from collections.abc import Callable

import pytest

from seacrane.native import build_library, source

WRAPPER = """
#include <stdarg.h>
#include <stddef.h>
int seacrane_format(char *text, size_t size, const char *format, va_list arguments);
static void format(char *text, size_t size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    seacrane_format(text, size, format, arguments);
    va_end(arguments);
}
#define EXPORT __attribute__((visibility("default")))
EXPORT void format_real(char *text, size_t size, const char *pattern, double x) { format(text, size, pattern, x); }
EXPORT void format_others(char *text, size_t size, const char *name, int n, unsigned m)
{
    format(text, size, "%s is %d of %u: 100%%", name, n, m);
}
"""
SPECIAL = (0.0, -0.0, math.inf, -math.inf, math.nan, 1.0, 10.0, 1e5, 1e6, 99999.95, 999999.5, 9.9999999, 1e-4, 9.99e-5,
           0.1, 1 / 3, -2.5e-7, 123456789.0, 1e15, 1e-14, 1e300, 1e-280, 999999999999.0)  # fmt: skip


@pytest.fixture(scope="module")
def library() -> ctypes.CDLL:
    return ctypes.CDLL(str(build_library("format", {**source("wasm.c"), "wrapper.c": WRAPPER})))


@pytest.fixture(scope="module")
def written(library: ctypes.CDLL) -> Callable[[str, float], str]:
    text = ctypes.create_string_buffer(64)

    def write(pattern: str, value: float) -> str:
        library.format_real(text, ctypes.c_size_t(64), pattern.encode(), ctypes.c_double(value))
        return text.value.decode()

    return write


@pytest.mark.parametrize("pattern", ["%g", "%.3g", "%.9g", "%.12g"])
def test_numbers_are_written_as_printf_writes_them(pattern: str, written: Callable[[str, float], str]) -> None:
    chance = random.Random(4)
    values = [*SPECIAL, *(chance.uniform(-1, 1) * 10 ** chance.uniform(-20, 20) for _ in range(5000))]
    digits = int(pattern[2:-1] or 6)
    for value in values:
        found, wanted = written(pattern, value), pattern % value
        if found != wanted:  # halfway between two decimals, where the last digit may go either way
            assert float(found) == pytest.approx(float(wanted), rel=1.01 * 10.0 ** (1 - digits))


def test_texts_and_whole_numbers_are_written_and_cut_where_the_room_ends(library: ctypes.CDLL) -> None:
    text = ctypes.create_string_buffer(64)
    for n in (0, 7, -3, -(2**31)):
        library.format_others(text, ctypes.c_size_t(64), b"piston", n, ctypes.c_uint(2**32 - 1))
        assert text.value.decode() == f"piston is {n} of 4294967295: 100%"
    library.format_others(text, ctypes.c_size_t(10), b"piston", -3, ctypes.c_uint(8))
    assert text.value == b"piston is"
