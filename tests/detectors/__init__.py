"""Detectors: how any is asked, where to act on what it found, and those of `transformers`."""
