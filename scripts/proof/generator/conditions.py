"""Families whose names start with OTHER have effects with other formulas than the catalogue. Their conditions are the usual ones."""

OTHER = "other_"


def condition_of(family: str) -> str:
    """The family whose conditions a family has."""
    return family.removeprefix(OTHER)
