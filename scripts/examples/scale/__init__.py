"""Work spread over Dask workers: drives of the FMU, and the tool on recordings."""

import sys
from importlib.util import find_spec

for _name in ("dask", "distributed"):
    if find_spec(_name) is None:
        sys.exit(f"{sys.argv[0]}: the Python package {_name} is missing; install it with scripts/setup.sh scale")
