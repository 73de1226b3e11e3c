"""The library of effects, one file each; `docs/effects.md` lists them."""
