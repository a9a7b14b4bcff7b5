"""Simulated worlds: our own tabletop, and adapters to other people's simulators."""
