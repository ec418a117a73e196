"""Families of other worlds have the conditions of the usual ones; their names begin with OTHER."""

OTHER = "other_"


def condition_of(family: str) -> str:
    """The family whose conditions a family has."""
    return family.removeprefix(OTHER)
