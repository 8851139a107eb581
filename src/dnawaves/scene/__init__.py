"""What an experiment declares, read and checked before anything runs."""
