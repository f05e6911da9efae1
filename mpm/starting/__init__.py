"""Starting: where the shipped scenes and the docs lie, copies of them for users, and bare configs to begin from.

    places   the folders of configs and docs, in a checkout and in an installed wheel
    scenes   the shipped scenes by name; one of them, with the files that it reads, as it stands in a user's folder
    bare     a commented config of a dimension and of some physics

Reads text only: `mpm new` imports nothing heavy. To add a scene: a YAML in configs/scenes. To add physics to bare configs: a section in bare.py.
"""
