"""mpm schema: JSON Schema of configs, for editors."""

from mpm_cli.talk import document


def schema() -> None:
    """Print the JSON Schema of configs.

    An editor reads it through the line `# yaml-language-server: $schema=...` of a config.
    """
    from mpm.config import schema as schema_of

    document(schema_of())
