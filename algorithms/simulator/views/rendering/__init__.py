"""From rays to pixels: what they hit, in which light it lies, what a lens makes of it."""
