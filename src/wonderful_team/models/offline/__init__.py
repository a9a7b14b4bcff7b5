"""The offline model: classical vision and a grammar. No key, no weights, no network."""
