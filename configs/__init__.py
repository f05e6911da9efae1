"""The configs that ship, installed as `mpm_configs`: scenes, problems with exact solutions, measured curves. `mpm new` copies them."""
