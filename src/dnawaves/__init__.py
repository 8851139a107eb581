"""Waves along DNA: all-atom simulation held against elastic-rod theory."""
