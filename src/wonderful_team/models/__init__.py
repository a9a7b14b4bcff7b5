"""The client of models: providers, wire formats, conventions, cache and caps; scripted models and wrappers."""
