"""The public table: libraries, robots, terms."""
