"""What recording costs: CPU time per second recorded, for 500 signals at 1 kHz, into each kind of file.

Rows are handed over in pieces of 150 ms, as a run in real time does. The signals are sines with noise, which hardly
compress: the worst case. The best of the rounds counts.

    python benchmarks/recording.py [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path

import numpy as np

from seacrane.cosim import ArrowRecorder, CsvRecorder, MemoryRecorder, Observer
from seacrane.results import convert

SIGNALS, RATE, SECONDS, PIECE = 500, 1000, 4, 150


def data() -> np.ndarray:
    t = np.arange(SECONDS * RATE) / RATE
    random = np.random.default_rng(1)
    columns = [1e6 * np.sin(t * (1 + i / 50)) + random.normal(size=t.size) for i in range(SIGNALS)]
    return np.column_stack([t, *columns])


def cost(observer: Observer, table: np.ndarray) -> float:
    """CPU time of this process, all its threads, per second recorded [s]."""
    begun = time.process_time()
    observer.open({f"s.y{i}": ("Pa", "bar") for i in range(SIGNALS)})
    for first in range(0, len(table), PIECE):
        observer.write(table[first : first + PIECE])
        observer.flush()  # in real time each piece has been written when the next one comes
    observer.close()
    return (time.process_time() - begun) / SECONDS


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    table, rows = data(), []
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "run"
        kinds = {
            "memory": MemoryRecorder,
            "arrow": lambda: ArrowRecorder(file.with_suffix(".arrow")),
            "csv": lambda: CsvRecorder(file.with_suffix(".csv")),
        }
        for name, make in kinds.items():
            best = min(cost(make(), table) for _ in range(3))
            size = file.with_suffix(f".{name}").stat().st_size if name != "memory" else table.nbytes
            rows.append({"kind": name, "cpu_ms_per_s": 1e3 * best, "bytes_per_value": size / table.size})
        begun = time.process_time()
        convert(file.with_suffix(".arrow"), file.with_suffix(".parquet"))
        taken = (time.process_time() - begun) / SECONDS
        size = file.with_suffix(".parquet").stat().st_size
        rows.append({"kind": "arrow to parquet", "cpu_ms_per_s": 1e3 * taken, "bytes_per_value": size / table.size})
    for row in rows:
        print(
            f"{row['kind']:18} {row['cpu_ms_per_s']:8.1f} ms per s recorded  {row['bytes_per_value']:6.2f} B per value"
        )
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
