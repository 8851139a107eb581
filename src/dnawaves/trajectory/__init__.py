"""Simulations: what excites a duplex, how it is integrated, what is recorded."""
