"""The error of a config that is valid but that no method here can run."""


class SceneError(ValueError):
    """A valid config that no method here can run; the message says what to change."""
