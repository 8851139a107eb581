"""From recorded motion to the displacement fields of the four waves."""
