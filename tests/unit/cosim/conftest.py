from pathlib import Path

import coupled
import pytest


@pytest.fixture(scope="session")
def coupled_fmus(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return coupled.exported(tmp_path_factory.mktemp("coupled"))
