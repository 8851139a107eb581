"""Spectra and speeds: what the recorded waves say, each estimator with its misfit."""
