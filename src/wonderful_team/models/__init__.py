"""The client of models, and the models that need no key: offline, scripted, wrappers."""
