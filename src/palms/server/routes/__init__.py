"""Routes: one file for each noun of the REST interface, and the socket."""
