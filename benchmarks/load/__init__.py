"""The load test: many phones at once, over real sockets."""
