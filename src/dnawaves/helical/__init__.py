"""Base-pair and base-pair-step parameters of DNA, in the convention of 3DNA."""
