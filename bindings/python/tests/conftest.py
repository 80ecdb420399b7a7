import json
import os
from pathlib import Path

import matplotlib
import pytest

matplotlib.use("Agg")


@pytest.fixture(scope="session")
def vectors():
    """The test vectors of the C library: TRIBO_VECTORS, or beside this binding."""
    default = Path(__file__).resolve().parents[2] / "vectors.json"
    return json.loads(Path(os.environ.get("TRIBO_VECTORS", default)).read_text())
