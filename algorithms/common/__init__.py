"""What every other package stands on: errors, poses, ranges of settings, compiled kernels."""
