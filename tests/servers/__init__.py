"""Local servers that speak the vendors' wire formats, for tests over real sockets."""
