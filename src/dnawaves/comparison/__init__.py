"""All scenes side by side, held against the theory."""
