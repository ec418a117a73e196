"""An independent simulator of skid-steer vehicles on soft ground, and the test recordings made with it."""

import hashlib
import os
from pathlib import Path

# Numba's cache does not see that a function of another file changed: one folder of compiled code per state of the sources
_SOURCES = sorted(Path(__file__).parent.glob("*.py"))
_DIGEST = hashlib.sha256(b"".join(path.read_bytes() for path in _SOURCES)).hexdigest()[:16]
os.environ.setdefault("NUMBA_CACHE_DIR", str(Path(__file__).parents[3] / "target" / "numba" / _DIGEST))
