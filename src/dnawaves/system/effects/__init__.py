"""The effects that a scene may call for, one small module each, with explicit arguments."""
