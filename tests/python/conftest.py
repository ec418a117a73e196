"""What pytest knows of these tests beside their names."""


def pytest_configure(config) -> None:
    """Tests that take minutes run in `scripts/test.sh --all` alone."""
    config.addinivalue_line("markers", "nightly: runs in scripts/test.sh --all alone")
