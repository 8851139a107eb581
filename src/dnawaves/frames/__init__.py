"""Rigid frames of bases and base pairs: the standard frame, and parameters between frames."""
