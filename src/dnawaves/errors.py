"""Errors that a user can act on."""

from __future__ import annotations


class InputError(ValueError):
    """The user gave what cannot be used; says where, what was found and what is allowed."""


class SimulationError(RuntimeError):
    """A simulation left the range in which its numbers mean anything."""
