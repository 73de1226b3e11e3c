"""The library of effects, one file each; `docs/theory-gap.md` lists them."""
