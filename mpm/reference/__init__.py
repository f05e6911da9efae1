"""Reference: what a word of a config, a dataset or a message means. `mpm explain` and the reference pages of the docs are made of the same entries.

    entry      one entry, as text for a terminal and as Markdown
    keys       keys and kinds of configs, from the models
    results    statuses, outcomes, warnings, exit codes, variables, sides and walls, from the tables that the program itself uses
    sections   sections of docs/trouble.md and docs/glossary.md by the words in their headings: causes and cures, terms
    lookup     all entries, those that a word means, and the nearest ones
    pages      the reference pages of the docs

Nothing is written down twice: what a key means stands in its model, units and names in mpm.records.variables, causes and cures in docs/trouble.md.
"""
