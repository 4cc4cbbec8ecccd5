"""Faults of robot descriptions: what no body has, what nobody meant, and what it does to which term."""
