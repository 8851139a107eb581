"""Elastic-rod theory of DNA: constants, dispersion, finite chains and standing waves."""
