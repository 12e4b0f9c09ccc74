"""What the benchmark of the masters takes for the FMUs by themselves is what they do in a run."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

from seacrane.cosim import Execution, Jacobi

FOLDER = Path(__file__).parents[3] / "benchmarks"


@pytest.fixture(scope="module")
def cases():
    sys.path.insert(0, str(FOLDER))
    try:
        return importlib.import_module("cosim_cases")
    finally:
        sys.path.remove(str(FOLDER))


def test_fmus_alone_give_the_outputs_of_the_coupled_run_bit_by_bit(cases, tmp_path):
    case = cases.chain(cases.make_oscillator(tmp_path), 3, substeps=2)
    alone = cases.Alone(case, tmp_path)
    alone.step(50)
    alone.step(30)
    with Execution(cases.system(case), Jacobi(case.step)) as run:
        run.step(80)
        coupled = run.values([".".join(end) for end in case.logged])
    given = np.concatenate([outputs for _, _, outputs, _ in alone.kept])
    assert np.array_equal(given, coupled)
    assert np.all(given != 0)
