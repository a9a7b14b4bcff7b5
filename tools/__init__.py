"""Scripts for a checkout: setting it up, and a tiny model to try servers with."""
