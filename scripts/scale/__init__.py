"""Work spread over Dask workers: drives of the FMU, and the tool on recordings."""
