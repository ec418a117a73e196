"""Names of families in which mechanisms act by other formulas begin with OTHER. Their conditions are those of the usual families."""

OTHER = "other_"


def condition_of(family: str) -> str:
    """The family whose conditions a family has."""
    return family.removeprefix(OTHER)
