"""Sequences, and the atoms of an ideal B-DNA duplex."""
