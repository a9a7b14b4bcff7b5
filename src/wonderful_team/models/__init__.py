"""The door to models, and the models that need no key: offline, scripted, wrappers."""
