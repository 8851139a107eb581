"""The duplex in its environment: forces, masses, geometry, and the minimum it starts from."""
