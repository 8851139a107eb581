"""The constants of a rod, from the molecule that the waves run in."""
