"""`python -m dnawaves`: the command line."""

from dnawaves.cli import main

main()
