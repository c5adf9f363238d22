"""What can be wrong with what was given."""


class InvalidInput(ValueError):
    """Bad input; the message names it, its place and the cure."""


class MeshWarning(UserWarning):
    """What is probably not meant: units, large holes, a boundary farther from its surface than asked for."""
