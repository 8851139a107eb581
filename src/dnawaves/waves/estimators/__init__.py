"""Estimators on arrays: what a wave, a spectrum or an arrival says, with its interval."""
