"""Hard cases: what is expected of each is declared first, and then held against what is found."""
