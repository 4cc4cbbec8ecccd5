"""What is to be computed: algorithms run on symbols, and the order, cuts and places of their operations."""
